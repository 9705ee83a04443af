#include "trials/trial_key.h"

#include "options/option_keys.h"
#include "process/programs.h"
#include "process/sha256.h"
#include "rows/codec.h"
#include "trials/counter_tool.h"
#include "trials/ranks.h"
#include "trials/record.h"

namespace podm::bench {
namespace {

// Returns the part of the machine that decides the outcome. Virtual workers are spread over the NUMA nodes of
// this machine if the trial describes no machine. Cachegrind simulates, too, but if it is missing, the trial
// is measured.
Json machine_that_counts(const Json& options, const MachineRecord& machine) {
  const bool is_simulated = basis_of(options, {}) == Basis::kSimulated;
  if (!is_simulated || options.value(kCounters, "") == kCachegrind) return to_json(machine);
  return options.contains("topology") ? Json() : to_json(machine.numa_nodes);
}

}  // namespace

std::string key_of(const KeyParts& parts) {
  const Json identity = {{"mesher", parts.mesher},
                         {"input", parts.input},
                         {"trial", parts.trial},
                         {"options", parts.options},
                         {"machine", machine_that_counts(parts.options, parts.machine)},
                         {"repeat", parts.repeat},
                         {"warmup", parts.is_warmup}};
  return sha256_of(identity.dump());
}

std::string TrialKeys::of(const Trial& trial, const Turn& turn, const Preparation& preparation) {
  Json options = with_radius(trial.options, preparation.resolved);
  if (options.contains("topology")) options["topology"] = hashes_.of(options["topology"]);
  return key_of({.mesher = !makes_mesh(trial)     ? "none"
                           : is_of_peer(trial)    ? peers_.of(trial).sha256()
                           : num_ranks(trial) > 0 ? hashes_.of(podm_mpi_of(podm_))
                                                  : mesher_sha256_,
                 .input = preparation.sha256,
                 .trial = trial.name,
                 .options = std::move(options),
                 .machine = machine_,
                 .repeat = turn.repeat,
                 .is_warmup = turn.is_warmup});
}

}  // namespace podm::bench
