// The public API: options checked, phases timed, PODM run, mesh extracted and measured.
#include "podm/mesh_image.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cost_model.h"
#include "extract_mesh.h"
#include "measure_quality.h"
#include "podm.h"
#include "podm/operation_log.h"
#include "replay.h"

namespace podm {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kBytesPerCell = sizeof(Cell) + sizeof(CellState) + sizeof(Vertex) / 4;

bool is_positive_or_zero(double x) { return std::isfinite(x) && x >= 0; }

void check(const LabelImage& image, const MeshingOptions& options) {
  if (!is_positive_or_zero(options.radius_mm)) throw InputError("radius must be a positive number of mm");
  if (!is_positive_or_zero(options.delta_mm)) throw InputError("delta must be a positive number of mm");
  for (const auto& [value, radius] : options.radius_of_mm) {
    const auto has_value = [v = value](const Label& label) { return label.value == v; };
    if (std::none_of(image.labels.begin() + 1, image.labels.end(), has_value)) {
      throw InputError("radius of label " + std::to_string(value) + ": the image has no such label");
    }
    if (!(std::isfinite(radius) && radius > 0)) {
      throw InputError("radius of label " + std::to_string(value) + " must be a positive number of mm");
    }
  }
  if (options.target_elements > 0 && options.radius_mm > 0) {
    throw InputError("a target number of elements excludes a radius");
  }
  if (image.labels.size() < 2 || image.voxels.size() != image.num_voxels()) {
    throw InputError("the image has no foreground");
  }
}

SizeField size_field(const LabelImage& image, const MeshingOptions& options, double radius_mm) {
  std::vector<double> radius(image.labels.size(), radius_mm > 0 ? radius_mm : kInfinity);
  for (std::size_t i = 1; i < image.labels.size(); ++i) {
    const auto own = options.radius_of_mm.find(image.labels[i].value);
    if (own != options.radius_of_mm.end()) radius[i] = own->second;
  }
  return SizeField(std::move(radius));
}

std::size_t cell_capacity(const MeshingOptions& options) {
  const std::uint64_t machine = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                                static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  const std::uint64_t bytes = options.max_memory_bytes > 0 ? options.max_memory_bytes : machine;
  return std::min<std::uint64_t>(bytes / kBytesPerCell + (1 << 17), 1u << 30);
}

// One call of mesh_image: what its phases share.
class Run {
 public:
  Run(const LabelImage& image, const MeshingOptions& options, const ProgressCallback& progress,
      std::stop_token stop)
      : image_(image), options_(options), progress_(progress), stop_(std::move(stop)) {}

  MeshingResult operator()() {
    check(image_, options_);
    announce("transform", 0, 0);
    const Clock::time_point start = Clock::now();
    const Isosurface isosurface(image_, options_.loop_threads());
    MeshingResult result;
    MeshingReport& report = result.report;
    report.phases_s["transform"] = seconds_since(start);

    const Clock::time_point refine_start = Clock::now();
    Refinement refinement = options_.target_elements > 0
                                ? refine_to_target(isosurface, report)
                                : refine(isosurface, options_.radius_mm, delta(), report);
    report.phases_s["refine"] = seconds_since(refine_start);
    report.stop_reason = refinement.stop_reason;
    report.counters = refinement.counters;
    report.store_cells = refinement.mesh->num_cells();
    const auto& [low, high] = refinement.mesh->box();
    report.virtual_box = {low.x, low.y, low.z, high.x, high.y, high.z};
    report.virtual_s = refinement.virtual_s;
    extract(isosurface, refinement, result);
    return result;
  }

 private:
  void announce(const char* phase, double fraction, std::uint64_t cells) const {
    if (progress_) progress_({phase, std::clamp(fraction, 0.0, 1.0), cells, seconds_since(start_)});
  }

  Refinement refine(const Isosurface& isosurface, double radius_mm, double delta_mm, MeshingReport& report) {
    report.radius_mm = radius_mm;
    report.delta_mm = delta_mm;
    MeshingOptions resolved = options_;
    resolved.radius_mm = radius_mm;
    resolved.delta_mm = report.delta_mm;
    resolved.target_elements = 0;
    const double expected = estimate(image_, resolved).cells;
    Limits limits{options_.max_elements, Clock::time_point::max()};
    if (options_.max_seconds > 0) {
      limits.deadline = start_ + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(options_.max_seconds));
    }
    Watch watch(limits, stop_, [&](std::uint64_t cells) {
      announce("refine", static_cast<double>(cells) / expected, cells);
    });
    if (options_.log != nullptr) options_.log->restart();
    return podm(isosurface, foreground_bounds(image_, options_.loop_threads()), report.delta_mm,
                size_field(image_, options_, radius_mm), cell_capacity(options_), crew(), watch);
  }

  Crew crew() const {
    const CoordinationOptions coordination{
        std::max(1, options_.threads), options_.contention, {}, options_.seed};
    return {options_.executor, coordination, options_.virtual_cost, options_.log};
  }

  double delta() const {
    if (options_.delta_mm > 0) return options_.delta_mm;
    double smallest = options_.radius_mm > 0 ? options_.radius_mm : kInfinity;
    for (const auto& [value, radius] : options_.radius_of_mm) smallest = std::min(smallest, radius);
    return default_delta_mm(image_, std::isinf(smallest) ? 0 : smallest);
  }

  // A cheap coarse run calibrates the power law cells ~ radius^exponent, then full runs are corrected by it
  // until they are close. Unless given, delta follows the radius, or the interfaces alone could exceed the
  // target.
  Refinement refine_to_target(const Isosurface& isosurface, MeshingReport& report) {
    const auto target = static_cast<double>(options_.target_elements);
    double radius = radius_for_cells(image_, target / 8, options_.loop_threads()), last_radius = 0,
           last_cells = 0;
    for (int runs = 1;; ++runs) {
      Refinement refinement =
          refine(isosurface, radius, options_.delta_mm > 0 ? options_.delta_mm : radius / 2, report);
      const auto cells = std::max(
          1.0, static_cast<double>(label_cells(*refinement.mesh, isosurface, options_.loop_threads())));
      const bool is_met = std::abs(cells / target - 1) <= kTargetTolerance;
      if (is_met || runs == kMaxTargetRuns || refinement.stop_reason != StopReason::kComplete) {
        if (!is_met) report.warnings.push_back("the target number of elements was not met within 5 %");
        return refinement;
      }
      const double exponent =
          last_radius > 0 ? std::log(cells / last_cells) / std::log(radius / last_radius) : kFirstExponent;
      last_radius = radius;
      last_cells = cells;
      radius *= std::pow(target / cells, 1 / std::clamp(exponent, -4.0, -0.5));
    }
  }

  void extract(const Isosurface& isosurface, Refinement& refinement, MeshingResult& result) {
    announce("extract", 0, 0);
    const Clock::time_point start = Clock::now();
    MeshingReport& report = result.report;
    const bool is_voxel = options_.space == Space::kVoxel;
    result.mesh = extract_mesh(*refinement.mesh, isosurface, image_, is_voxel ? Space::kRas : options_.space,
                               options_.loop_threads(), report.guarantees.facet_vertices);
    refinement.mesh.reset();
    report.phases_s["extract"] = seconds_since(start);
    measure_quality(result.mesh, image_, size_field(image_, options_, report.radius_mm), report);
    if (is_voxel) convert_to_voxel_space(result.mesh, image_);
  }

  static constexpr int kMaxTargetRuns = 8;
  static constexpr double kTargetTolerance = 0.045;  // of the 5 % promised
  static constexpr double kFirstExponent = -2.6;     // between the surface's -2 and the volume's -3
  const LabelImage& image_;
  const MeshingOptions& options_;
  const ProgressCallback& progress_;
  std::stop_token stop_;
  const Clock::time_point start_ = Clock::now();
};

}  // namespace

std::string to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kComplete:
      return "complete";
    case StopReason::kCancelled:
      return "cancelled";
    case StopReason::kElementLimit:
      return "element limit";
    case StopReason::kTimeLimit:
      return "time limit";
    case StopReason::kMemoryLimit:
      return "memory limit";
  }
  throw InternalError("unknown stop reason");
}

std::string to_string(Contention contention) {
  switch (contention) {
    case Contention::kAggressive:
      return "aggressive";
    case Contention::kRandom:
      return "random";
    case Contention::kGlobal:
      return "global";
    case Contention::kLocal:
      return "local";
  }
  throw InternalError("unknown contention manager");
}

std::string to_string(Executor executor) { return executor == Executor::kThreads ? "threads" : "virtual"; }

std::string to_string(VirtualCost cost) { return cost == VirtualCost::kUnit ? "unit" : "measured"; }

MeshingResult mesh_image(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress, std::stop_token stop) {
  return Run(image, options, progress, std::move(stop))();
}

TetMesh replay_operations(const LabelImage& image, const OperationLog& log, Space space) {
  const std::unique_ptr<Mesh> refined = replay(log);
  const Isosurface isosurface(image, 0);
  std::uint64_t facets_off_isosurface = 0;
  const bool is_voxel = space == Space::kVoxel;
  TetMesh mesh =
      extract_mesh(*refined, isosurface, image, is_voxel ? Space::kRas : space, 0, facets_off_isosurface);
  if (is_voxel) convert_to_voxel_space(mesh, image);
  return mesh;
}

}  // namespace podm
