#include "trial_key.h"

#include <filesystem>

#include "sha256.h"

namespace podm::bench {

const std::string& TrialKeys::content_of(const std::string& path) {
  const auto [entry, is_new] = content_.try_emplace(path);
  if (is_new) entry->second = std::filesystem::exists(path) ? sha256_of_file(path) : "absent";
  return entry->second;
}

std::string TrialKeys::of(const Trial& trial, const Turn& turn) {
  nlohmann::ordered_json options = trial.options;
  if (options.contains("topology")) options["topology"] = content_of(options["topology"]);
  const nlohmann::ordered_json identity = {
      {"mesher", !makes_mesh(trial)  ? "none"
                 : is_of_peer(trial) ? peers_.of(trial).sha256()
                                     : mesher_sha256_},
      {"input", is_phantom(trial.image) || !makes_mesh(trial) ? trial.image : content_of(trial.image)},
      {"trial", trial.name},
      {"options", options},
      {"machine", machine_},
      {"repeat", turn.repeat},
      {"warmup", turn.is_warmup}};
  return sha256_of(identity.dump());
}

}  // namespace podm::bench
