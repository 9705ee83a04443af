#include "trials/preparation.h"

#include <fmt/format.h>

#include "options/option_keys.h"

namespace podm::bench {

Json resolved_options(const Trial& trial, const Preparation& preparation) {
  Json options = trial.options;
  if (!preparation.resolved) return options;
  options.erase(kTargetElements);
  options["radius_mm"] = preparation.resolved->radius_mm;
  options["delta_mm"] = preparation.resolved->delta_mm;
  return options;
}

Preparer::Preparer(const std::string& podm, const std::string& podm_sha256, const std::string& results_folder)
    : inputs_(podm, podm_sha256, results_folder + "/inputs"),
      radii_(podm, podm_sha256, results_folder + "/radii.jsonl") {}

std::optional<Preparation> Preparer::find(const Trial& trial) {
  if (!makes_mesh(trial)) return Preparation{};
  if (!inputs_.is_there(trial.image)) return {};
  const std::string path = inputs_.path_of(trial.image);
  Preparation preparation{path, hashes_.of(path), {}};
  if (!trial.options.contains(kTargetElements)) return preparation;
  preparation.resolved = radii_.find(trial, preparation.sha256);
  return preparation.resolved ? std::optional(preparation) : std::nullopt;
}

Preparation Preparer::make(const Trial& trial, const std::string& scratch_folder, const Announce& announce,
                           const StopQuery& stop_requested) {
  const Json wanted = {trial.image, trial.options.value(kTargetElements, Json()),
                       trial.options.value("delta_mm", Json()), trial.timeout_s, trial.memory_limit_gib};
  if (const auto failed = failures_.find(wanted.dump()); failed != failures_.end()) throw failed->second;
  try {
    return make_anew(trial, scratch_folder, announce, stop_requested);
  } catch (const PreparationError& error) {
    const auto remembered = failures_.emplace(wanted.dump(), error).first;
    remembered->second.process = {};  // the failed process counts once
    throw;
  }
}

Preparation Preparer::make_anew(const Trial& trial, const std::string& scratch_folder,
                                const Announce& announce, const StopQuery& stop_requested) {
  if (!inputs_.is_there(trial.image)) {
    announce("drawing " + trial.image);
    inputs_.draw(trial.image, scratch_folder, stop_requested);
  }
  if (const auto found = find(trial)) return *found;
  const std::string path = inputs_.path_of(trial.image);
  announce(fmt::format("finding the radius of {} cells", trial.options[kTargetElements].dump()));
  return {path, hashes_.of(path),
          radii_.resolve(trial, path, hashes_.of(path), scratch_folder, stop_requested)};
}

}  // namespace podm::bench
