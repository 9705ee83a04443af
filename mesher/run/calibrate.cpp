#include "run/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "prediction/radius_search.h"
#include "run/extract_mesh.h"

namespace podm {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

constexpr double kShareOfTolerance = 0.9;  // the search aims at a smaller tolerance than promised

bool is_near(std::uint64_t cells, const SizeOptions& sizes) {
  const double tolerance = kShareOfTolerance * sizes.target_tolerance_percent / 100;
  return std::abs(static_cast<double>(cells) / static_cast<double>(sizes.target_elements) - 1) <= tolerance;
}

}  // namespace

// If the first mesh with the predicted radius misses the target, its number of cells gives the error of the
// prediction. A further mesh is then made with a corrected radius.
Refinement refine_to_target(const LabelImage& image, const Isosurface& isosurface, const SizeOptions& sizes,
                            int threads, const MakeMesh& make_mesh, MeshingReport& report) {
  const Clock::time_point start = Clock::now();
  Calibration& calibration = report.calibration.emplace();
  calibration.target_elements = sizes.target_elements;
  RadiusSearch search(image, sizes, threads);
  for (;;) {
    const Clock::time_point mesh_start = Clock::now();
    calibration.seconds = seconds_between(start, mesh_start);
    calibration.radius_mm = search.sizes().radius_mm;
    Refinement refinement = make_mesh(search.sizes());
    const Clock::time_point label_start = Clock::now();
    const std::uint64_t cells = label_cells(*refinement.mesh, isosurface, threads);
    const bool is_met = is_near(cells, sizes);
    if (is_met || calibration.meshes.size() + 1 == static_cast<std::size_t>(sizes.target_meshes) ||
        refinement.stop_reason != StopReason::kComplete ||
        !search.learn(std::max(1.0, static_cast<double>(cells)))) {
      if (!is_met)
        report.warnings.push_back(fmt::format("the target number of elements was not met within {:g} %",
                                              sizes.target_tolerance_percent));
      report.phases_s["calibrate"] = calibration.seconds;
      report.phases_s["extract"] = seconds_between(label_start, Clock::now());
      return refinement;
    }
    calibration.meshes.push_back({.radius_mm = calibration.radius_mm,
                                  .cells = cells,
                                  .seconds = seconds_between(mesh_start, Clock::now())});
  }
}

}  // namespace podm
