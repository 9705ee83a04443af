#include "trials/preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "options/option_keys.h"
#include "trials/image_info.h"

namespace podm::bench {
namespace {

bool needs_voxels(const Trial& trial) {
  return std::ranges::any_of(
      kLengthsInVoxels, [&](const LengthInVoxels& length) { return trial.options.contains(length.key); });
}

}  // namespace

Json with_radius(Json options, const std::optional<ResolvedRadius>& resolved) {
  if (!resolved) return options;
  options.erase(kTargetElements);
  options["radius_mm"] = resolved->radius_mm;
  options["delta_mm"] = resolved->delta_mm;
  return options;
}

Json resolved_options(const Trial& trial, const Preparation& preparation) {
  Json options = with_radius(trial.options, preparation.resolved);
  if (!preparation.voxel_mm) return options;
  for (const auto& [key, key_in_mm] : kLengthsInVoxels) {
    if (!options.contains(key)) continue;
    options[key_in_mm] = options[key].get<double>() * *preparation.voxel_mm;
    options.erase(key);
  }
  return options;
}

Preparer::Preparer(const std::string& podm, const std::string& podm_sha256, const std::string& results_folder)
    : podm_(podm),
      inputs_(podm, podm_sha256, results_folder + "/inputs"),
      radii_(podm, podm_sha256, results_folder + "/radii.jsonl") {}

std::optional<Preparation> Preparer::find(const Trial& trial) {
  if (!makes_mesh(trial)) return Preparation{};
  if (!inputs_.is_there(trial.image)) return {};
  const std::string path = inputs_.path_of(trial.image);
  Preparation preparation{path, hashes_.of(path), {}, {}};
  if (needs_voxels(trial)) {
    const auto voxel = voxels_mm_.find(path);
    if (voxel == voxels_mm_.end()) return {};
    preparation.voxel_mm = voxel->second;
  }
  if (!trial.options.contains(kTargetElements)) return preparation;
  preparation.resolved = radii_.find(trial, preparation.sha256);
  return preparation.resolved ? std::optional(preparation) : std::nullopt;
}

void Preparer::measure_voxel(const std::string& path, const StopQuery& stop_requested) {
  if (voxels_mm_.contains(path)) return;
  const ImageInfo info = ask_for_info(podm_, path, stop_requested);
  if (!info.voxel_volume_mm3)
    throw PreparationError("the size of voxels is not known", info.command, info.reply.outcome,
                           info.reply.messages);
  voxels_mm_[path] = std::cbrt(*info.voxel_volume_mm3);
}

Preparation Preparer::make(const Trial& trial, const std::string& scratch_folder, const Announce& announce,
                           const StopQuery& stop_requested) {
  const Json wanted = {trial.image,
                       trial.options.value(kTargetElements, Json()),
                       trial.options.value("delta_mm", Json()),
                       needs_voxels(trial),
                       trial.timeout_s,
                       trial.memory_limit_gib};
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
  const std::string path = inputs_.path_of(trial.image);
  if (needs_voxels(trial)) measure_voxel(path, stop_requested);
  if (const auto found = find(trial)) return *found;
  announce(fmt::format("finding the radius of {} cells", trial.options[kTargetElements].dump()));
  radii_.resolve(trial, path, hashes_.of(path), scratch_folder, stop_requested);
  return find(trial).value();
}

}  // namespace podm::bench
