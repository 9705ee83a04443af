#include "run/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace podm {

namespace {

constexpr double kShareOfTolerance = 0.9;  // the search aims at a smaller tolerance than promised

bool is_near(std::uint64_t cells, const SizeOptions& sizes) {
  const double tolerance = kShareOfTolerance * sizes.target_tolerance_percent / 100;
  return std::abs(static_cast<double>(cells) / static_cast<double>(sizes.target_elements) - 1) <= tolerance;
}

}  // namespace

// If the first mesh with the predicted radius misses the target, its number of cells gives the error of the
// prediction. A further mesh is then made with a corrected radius.
void refine_to_target(const SizeOptions& sizes, const TrialMeshes& meshes, MeshingReport& report) {
  const double start_s = meshes.seconds();
  Calibration& calibration = report.calibration.emplace();
  calibration.target_elements = sizes.target_elements;
  RadiusSearch search = meshes.begin_search();
  for (;;) {
    const double mesh_start_s = meshes.seconds();
    calibration.seconds = mesh_start_s - start_s;
    calibration.radius_mm = search.sizes().radius_mm;
    const StopReason reason = meshes.make(search.sizes());
    const double count_start_s = meshes.seconds();
    const std::uint64_t cells = meshes.count_cells();
    const bool is_met = is_near(cells, sizes);
    if (is_met || calibration.meshes.size() + 1 == static_cast<std::size_t>(sizes.target_meshes) ||
        reason != StopReason::kComplete || !search.learn(std::max(1.0, static_cast<double>(cells)))) {
      if (!is_met)
        report.warnings.push_back(fmt::format("the target number of elements was not met within {:g} %",
                                              sizes.target_tolerance_percent));
      report.phases_s["calibrate"] = calibration.seconds;
      report.phases_s["extract"] = meshes.seconds() - count_start_s;
      return;
    }
    calibration.meshes.push_back(
        {.radius_mm = calibration.radius_mm, .cells = cells, .seconds = meshes.seconds() - mesh_start_s});
  }
}

}  // namespace podm
