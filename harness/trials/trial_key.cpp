#include "trials/trial_key.h"

#include "trials/ranks.h"
#include "trials/sha256.h"

namespace podm::bench {

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
                         {"machine", to_json(machine_)},
                         {"repeat", turn.repeat},
                         {"warmup", turn.is_warmup}};
  return sha256_of(identity.dump());
}

}  // namespace podm::bench
