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
Json machine_that_counts(const Trial& trial, const MachineRecord& machine) {
  const bool is_simulated = basis_of(trial.options, {}) == Basis::kSimulated;
  if (!is_simulated || trial.options.value(kCounters, "") == kCachegrind) return to_json(machine);
  return trial.options.contains("topology") ? Json() : to_json(machine.numa_nodes);
}

}  // namespace

std::string TrialKeys::of(const Trial& trial, const Turn& turn, const Preparation& preparation) {
  Json options = resolved_options(trial, preparation);
  if (options.contains("topology")) options["topology"] = hashes_.of(options["topology"]);
  const Json identity = {{"mesher", !makes_mesh(trial)     ? "none"
                                    : is_of_peer(trial)    ? peers_.of(trial).sha256()
                                    : num_ranks(trial) > 0 ? hashes_.of(podm_mpi_of(podm_))
                                                           : mesher_sha256_},
                         {"input", preparation.sha256},
                         {"trial", trial.name},
                         {"options", options},
                         {"machine", machine_that_counts(trial, machine_)},
                         {"repeat", turn.repeat},
                         {"warmup", turn.is_warmup}};
  return sha256_of(identity.dump());
}

}  // namespace podm::bench
