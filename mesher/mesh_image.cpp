// The public API: options checked, phases timed, PODM run, mesh extracted and measured.
#include "podm/mesh_image.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "algorithms/placement_of_team.h"
#include "algorithms/podm.h"
#include "cost_model.h"
#include "extract_mesh.h"
#include "geometry/affine.h"
#include "image_owners.h"
#include "measure_quality.h"
#include "memory_model.h"
#include "page_sampler.h"
#include "podm/operation_log.h"
#include "radius_search.h"
#include "replay.h"

namespace podm {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_positive_or_zero(double x) { return std::isfinite(x) && x >= 0; }

void check_leaves(const MeshingOptions& options) {
  const int nodes = options.nodes, cores = options.cores_per_node, threads = options.threads;
  if (nodes > 0 && cores > 0 && threads > 0 && nodes * cores != threads)
    throw InputError("threads must be nodes times cores per node, or left out");
  if ((nodes > 0 && threads % nodes != 0) || (cores > 0 && threads % cores != 0))
    throw InputError("nodes must divide the threads evenly");
  if (options.algorithm == Algorithm::kPdr && cores > 1)
    throw InputError("pdr has one core per node; pdr-podm has more");
  if (options.initial_threads > std::max({1, threads, std::max(1, nodes) * std::max(1, cores)}))
    throw InputError("the initial mesh cannot have more threads than the whole run");
  if (!(std::isfinite(options.initial_ratio) && options.initial_ratio >= 1))
    throw InputError("the initial ratio must be 1 or more");
  if (!is_positive_or_zero(options.leaf_size_mm))
    throw InputError("leaf size must be a positive number of mm");
}

// Readers see to it; others may have left the affine out.
void check_affine(const LabelImage& image) {
  const Affine& a = image.voxel_to_ras;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double norm = std::hypot(a[axis], a[4 + axis], a[8 + axis]);
    if (!(norm > 0 && std::abs(norm - image.spacing[axis]) <= 1e-6 * norm))
      throw InputError("the image's spacing is not that of its affine (axis " + std::to_string(axis) + ")");
  }
  const double voxel_mm3 = image.spacing[0] * image.spacing[1] * image.spacing[2];
  if (!(std::abs(determinant(a)) > 1e-6 * voxel_mm3)) throw InputError("the image's affine is singular");
}

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
  check_leaves(options);
  if (options.target_elements > 0 && options.radius_mm > 0) {
    throw InputError("a target number of elements excludes a radius");
  }
  if (image.labels.size() < 2 || image.voxels.size() != image.num_voxels()) {
    throw InputError("the image has no foreground");
  }
  check_affine(image);
}

SizeField size_field(const LabelImage& image, const MeshingOptions& options, double radius_mm) {
  std::vector<double> radius(image.labels.size(), radius_mm > 0 ? radius_mm : kInfinity);
  for (std::size_t i = 1; i < image.labels.size(); ++i) {
    const auto own = options.radius_of_mm.find(image.labels[i].value);
    if (own != options.radius_of_mm.end()) radius[i] = own->second;
  }
  return SizeField(std::move(radius));
}

// One call of mesh_image: what its phases share.
class Run {
 public:
  Run(const LabelImage& image, const MeshingOptions& options, const ProgressCallback& progress,
      std::stop_token stop)
      : image_(image),
        options_(options),
        progress_(progress),
        stop_(std::move(stop)),
        placement_(place_team(options, num_workers())) {
    check(image_, options_);
  }

  MeshingResult operator()() {
    announce("transform", 0, 0);
    const Clock::time_point start = Clock::now();
    const Isosurface isosurface(image_, options_.loop_threads());
    MeshingResult result;
    MeshingReport& report = result.report;
    object_ = foreground_bounds(image_, options_.loop_threads());
    expected_cells_ = estimate(image_, options_).cells;
    report.phases_s["transform"] = seconds_since(start);
    locate_memory(isosurface);

    Refinement refinement = options_.target_elements > 0
                                ? refine_to_target(isosurface, report)
                                : refine(isosurface, options_.radius_mm, delta(), report);
    report.phases_s.merge(refinement.phases_s);
    report.stop_reason = refinement.stop_reason;
    report.counters = refinement.counters;
    report.workers = refinement.workers;
    report.num_nodes = placement_.machine.num_nodes();
    report.pages = pages_ ? std::move(refinement.pages) : PageSamples{{}, why_no_pages()};
    if (owners_) report.image_reads_unavailable = owners_->unavailable();
    report.store_cells = refinement.mesh->num_cells();
    const auto& [low, high] = refinement.mesh->box();
    report.virtual_box = {low.x, low.y, low.z, high.x, high.y, high.z};
    report.virtual_phases_s = refinement.virtual_phases_s;
    report.algorithm = algorithm();
    report.computing_nodes = algorithm() == Algorithm::kPodm ? 1 : leaf_options().num_nodes;
    report.num_leaves = refinement.num_leaves;
    report.schedule = std::move(refinement.schedule);
    extract(isosurface, refinement, result);
    measure(result);
    if (options_.space == Space::kVoxel) convert(result);
    return result;
  }

 private:
  void announce(const char* phase, double fraction, std::uint64_t cells) const {
    if (progress_) progress_({phase, std::clamp(fraction, 0.0, 1.0), cells, seconds_since(start_)});
  }

  // Whose memory is what; on one node all is near.
  void locate_memory(const Isosurface& isosurface) {
    if (placement_.machine.num_nodes() == 1) return;
    owners_ = owners_of_image(image_, isosurface.transform(), placement_, options_.seed, nodes_of_pages);
    if (placement_.is_real) pages_.emplace(placement_.machine, *owners_, nodes_of_pages);
  }
  std::string why_no_pages() const {
    return placement_.machine.num_nodes() == 1    ? "the machine has one NUMA node"
           : placement_.machine.is_this_machine() ? "workers of virtual time are on no node"
                                                  : "the machine is a described one";
  }

  Refinement refine(const Isosurface& isosurface, double radius_mm, double delta_mm, MeshingReport& report) {
    report.radius_mm = radius_mm;
    report.delta_mm = delta_mm;
    Limits limits{options_.max_elements, Clock::time_point::max()};
    if (options_.max_seconds > 0) {
      limits.deadline = start_ + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(options_.max_seconds));
    }
    StopControl stop_control(limits, stop_, [&](std::uint64_t cells) {
      announce("refine", static_cast<double>(cells) / expected_cells_, cells);
    });
    if (options_.log != nullptr) options_.log->restart();
    announce("refine", 0, 0);
    const std::uint64_t bytes = memory_of_run(options_);
    return run({isosurface, object_, report.delta_mm, size_field(image_, options_, radius_mm),
                cell_capacity(bytes, static_cast<std::uint64_t>(num_workers()), options_.executor), bytes},
               stop_control);
  }

  Refinement run(const Problem& problem, StopControl& stop_control) const {
    switch (algorithm()) {
      case Algorithm::kPdr:
        return pdr(problem, team(), leaf_options(), stop_control);
      case Algorithm::kPdrPodm:
        return pdr_podm(problem, team(), leaf_options(), stop_control);
      default:
        return podm(problem, team(), stop_control);
    }
  }

  Algorithm algorithm() const {
    if (options_.algorithm != Algorithm::kAuto) return options_.algorithm;
    return num_workers() < options_.crossover ? Algorithm::kPodm : Algorithm::kPdrPodm;
  }

  LeafOptions leaf_options() const {
    const int initial = options_.initial_threads > 0 ? options_.initial_threads : num_workers();
    return {num_computing_nodes(), options_.initial_ratio, initial, options_.leaf_size_mm,
            options_.with_schedule};
  }

  // As asked for; else as many as NUMA nodes that have workers, if they divide them evenly.
  int num_computing_nodes() const {
    if (algorithm() == Algorithm::kPdr) return num_workers();
    if (options_.nodes > 0) return options_.nodes;
    if (options_.cores_per_node > 0) return num_workers() / options_.cores_per_node;
    std::set<int> used;
    for (const Place& place : placement_.places) used.insert(place.node);
    const int nodes = static_cast<int>(used.size());
    return num_workers() % nodes == 0 ? nodes : 1;
  }

  Team team() const {
    return {options_.executor,
            {num_workers(), options_.contention, placement_.groups, options_.seed},
            options_.virtual_cost,
            options_.log,
            &placement_.machine,
            placement_.places,
            owners_ ? &*owners_ : nullptr,
            pages_ ? &*pages_ : nullptr};
  }
  int num_workers() const {
    if (options_.threads > 0) return options_.threads;
    return std::max(1, options_.nodes) * std::max(1, options_.cores_per_node);
  }

  double delta() const {
    if (options_.delta_mm > 0) return options_.delta_mm;
    return default_delta_mm(image_, smallest_radius_mm(options_));
  }

  // Most predicted radii meet the target with the first mesh; where one does not, its cells tell how the
  // prediction errs, and it is made again. What is spent on meshes that are dropped is calibration.
  Refinement refine_to_target(const Isosurface& isosurface, MeshingReport& report) {
    const Clock::time_point start = Clock::now();
    const auto target = static_cast<double>(options_.target_elements);
    Calibration& calibration = report.calibration.emplace();
    calibration.target_elements = options_.target_elements;
    RadiusSearch search(image_, options_);
    for (;;) {
      const Clock::time_point mesh_start = Clock::now();
      calibration.seconds = std::chrono::duration<double>(mesh_start - start).count();
      Refinement refinement = refine(isosurface, search.radius_mm(), search.delta_mm(), report);
      const Clock::time_point label_start = Clock::now();
      const std::uint64_t cells = label_cells(*refinement.mesh, isosurface, options_.loop_threads());
      const bool is_met = std::abs(static_cast<double>(cells) / target - 1) <= kTargetTolerance;
      if (is_met || calibration.meshes.size() == kMostTrialMeshes ||
          refinement.stop_reason != StopReason::kComplete ||
          !search.learn(std::max(1.0, static_cast<double>(cells)))) {
        if (!is_met) report.warnings.push_back("the target number of elements was not met within 5 %");
        calibration.radius_mm = report.radius_mm;
        report.phases_s["calibrate"] = calibration.seconds;
        report.phases_s["extract"] = seconds_since(label_start);
        return refinement;
      }
      calibration.meshes.push_back({report.radius_mm, cells, seconds_since(mesh_start)});
    }
  }

  void extract(const Isosurface& isosurface, Refinement& refinement, MeshingResult& result) {
    announce("extract", 0, 0);
    const Clock::time_point start = Clock::now();
    malloc_trim(0);  // what workers had is for the mesh now
    MeshingReport& report = result.report;
    const Space space = options_.space == Space::kVoxel ? Space::kRas : options_.space;  // for now
    result.mesh = extract_mesh(*refinement.mesh, isosurface, space, options_.loop_threads(),
                               report.guarantees.facet_vertices);
    refinement.mesh.reset();
    report.phases_s["extract"] += seconds_since(start);
  }

  // In mm.
  void measure(MeshingResult& result) {
    announce("measure", 0, 0);
    const Clock::time_point start = Clock::now();
    MeshingReport& report = result.report;
    measure_quality(result.mesh, image_, size_field(image_, options_, report.radius_mm),
                    options_.loop_threads(), report);
    report.phases_s["measure"] = seconds_since(start);
  }

  void convert(MeshingResult& result) {
    const Clock::time_point start = Clock::now();
    convert_to_voxel_space(result.mesh, image_, options_.loop_threads());
    result.report.phases_s["extract"] += seconds_since(start);
  }

  static constexpr std::size_t kMostTrialMeshes = 5;
  static constexpr double kTargetTolerance = 0.045;  // of the 5 % promised
  const LabelImage& image_;
  const MeshingOptions& options_;
  const ProgressCallback& progress_;
  std::stop_token stop_;
  const PlacementOfTeam placement_;
  std::optional<ImageOwners> owners_;
  std::optional<PageSampler> pages_;
  Box object_{};  // bounds of the foreground
  double expected_cells_ = 1;
  const Clock::time_point start_ = Clock::now();
};

}  // namespace

MeshingResult mesh_image(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress, std::stop_token stop) {
  return Run(image, options, progress, std::move(stop))();
}

TetMesh replay_operations(const LabelImage& image, const OperationLog& log, Space space) {
  const std::unique_ptr<Mesh> refined = replay(log);
  const Isosurface isosurface(image, 0);
  std::uint64_t facets_off_isosurface = 0;
  const bool is_voxel = space == Space::kVoxel;
  TetMesh mesh = extract_mesh(*refined, isosurface, is_voxel ? Space::kRas : space, 0, facets_off_isosurface);
  if (is_voxel) convert_to_voxel_space(mesh, image, 0);
  return mesh;
}

}  // namespace podm
