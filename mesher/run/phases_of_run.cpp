#include "run/phases_of_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "algorithms/memory_model.h"
#include "algorithms/mend_topology.h"
#include "image/foreground.h"
#include "optimize/optimize_mesh.h"
#include "podm/operation_log.h"
#include "prediction/cost_model.h"
#include "run/extract_lines.h"
#include "run/extract_mesh.h"
#include "run/facets_of_sides.h"
#include "run/measure_quality.h"
#include "run/report_on_smoothing.h"
#include "runtime/system_memory.h"
#include "runtime/virtual_threads.h"
#include "sizing/default_sizes.h"
#include "sizing/make_size_grid.h"
#include "sizing/thin_layers.h"
#include "smoothing/smooth_interfaces.h"
#include "workers/accounting.h"

namespace podm {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The requested bounds on dihedral angles that all cells keep: those of the optimisation, otherwise those of
// the perturbation. Angles are computed in rounded arithmetic; the margin exceeds its errors.
std::optional<std::array<double, 2>> dihedral_bounds_kept(const MeshingReport& report) {
  constexpr double kMarginDeg = 1e-9;
  std::vector<std::array<double, 2>> asked;
  if (const auto& done = report.optimization)
    asked.push_back({done->least_dihedral_deg, done->largest_dihedral_deg});
  if (const auto& done = report.perturbation)
    asked.push_back({done->min_dihedral_deg, done->max_dihedral_deg});
  for (const auto& [least, largest] : asked)
    if (report.quality.min_dihedral_deg >= least + kMarginDeg &&
        report.quality.max_dihedral_deg <= largest - kMarginDeg)
      return {{least, largest}};
  return std::nullopt;
}

}  // namespace

PhasesOfRun::PhasesOfRun(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress, std::stop_token stop, double share_of_cells,
                         Seconds seconds)
    : image_(image),
      options_(options),
      progress_(progress),
      stop_(std::move(stop)),
      team_(options),
      loop_threads_(podm::loop_threads(options.team)),
      share_of_cells_(share_of_cells),
      seconds_(std::move(seconds)) {}

double PhasesOfRun::seconds_on_the_wall() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

void PhasesOfRun::announce(const char* phase, double fraction, std::uint64_t cells) const {
  if (progress_) progress_({phase, std::clamp(fraction, 0.0, 1.0), cells, seconds_since(start_)});
}

void PhasesOfRun::transform(MeshingReport& report) {
  transform(report, [&](std::shared_ptr<const VoxelWeights> weights) {
    return std::make_shared<const Isosurface>(image_, loop_threads_, std::move(weights));
  });
}

void PhasesOfRun::transform(MeshingReport& report, const MakeIsosurface& make) {
  auto weights = options_.smoothing_mm > 0 ? smooth(report) : nullptr;
  if (options_.lines.are_kept) trace(weights, report);
  announce("transform", 0, 0);
  const double start_s = seconds_();
  if (image_.is_box_flat && !lines_) box_curves_ = traced(weights.get(), {.is_box_flat = true});
  isosurface_ = make(std::move(weights));
  object_ = foreground_bounds(image_, loop_threads_);
  asked_grid_ = make_size_grid(image_, options_.sizes, loop_threads_);
  expected_ = estimate(image_, options_, asked_grid_.get());
  report.phases_s["transform"] = seconds_() - start_s;
  team_.locate_memory(image_, isosurface_->transform());
}

std::shared_ptr<const VoxelWeights> PhasesOfRun::smooth(MeshingReport& report) const {
  announce("smooth", 0, 0);
  const double start_s = seconds_();
  const SmoothInterfaces smoothed = smooth_interfaces(image_, options_.smoothing_mm, loop_threads_);
  report.smoothing = report_on_smoothing(image_, options_.smoothing_mm, smoothed, loop_threads_);
  if (keeps_all_stairs(image_, options_.smoothing_mm))
    report.warnings.push_back(
        fmt::format("a blur of {:g} mm, below half a voxel, smooths nothing", options_.smoothing_mm));
  for (const SmoothingReport::OfLabel& label : report.smoothing->labels)
    if (label.is_thin)
      report.warnings.push_back(fmt::format(
          "label {} ({:.4g} mm^3) is thin for a blur of {:g} mm, which would lose most of it: it was "
          "blurred by less",
          label.value, label.voxels_mm3, options_.smoothing_mm));
  report.phases_s["smooth"] = seconds_() - start_s;
  return smoothed.weights;
}

void PhasesOfRun::trace(const std::shared_ptr<const VoxelWeights>& weights, MeshingReport& report) {
  announce("lines", 0, 0);
  const double start_s = seconds_();
  LineNetwork network = traced(weights.get(), {.has_lines = true, .is_box_flat = image_.is_box_flat});
  if (image_.is_box_flat) {
    box_curves_ = part_of(network, [](const LineArc& arc) { return arc.sides != 0; });
    network = part_of(network, [](const LineArc& arc) { return arc.labels.size() >= kLabelsOfLine; });
  }
  lines_ = std::make_unique<const Lines>(std::move(network), image_, weights);
  report.phases_s["trace"] = seconds_() - start_s;
}

LineNetwork PhasesOfRun::traced(const VoxelWeights* weights, LineOptions options) const {
  StopControl stop(
      {.max_elements = 0, .max_seconds = options_.limits.max_seconds}, stop_, [](std::uint64_t) {}, start_);
  options.threads = loop_threads_;
  options.is_over = [&] {
    stop.check_limits();
    return stop.is_over();
  };
  options.most_bytes = memory_of_run(options_.limits);
  return trace_lines(image_, weights, options);
}

void PhasesOfRun::refine(const SizeOptions& sizes, const Refine& refine) {
  sizes_ = sizes;
  const bool is_as_asked = options_.sizes.target_elements == 0;
  size_field_ =
      size_field(image_, sizes, is_as_asked ? asked_grid_ : make_size_grid(image_, sizes, loop_threads_));
  const auto observe = [&](std::uint64_t cells) {
    announce("refine", static_cast<double>(cells) / (share_of_cells_ * expected_.cells), cells);
  };
  StopControl stop_control(options_.limits, stop_, observe, start_);
  if (options_.log != nullptr) options_.log->restart();
  team_.forget_reads();
  announce("refine", 0, 0);
  const auto num_workers = static_cast<std::uint64_t>(team_.size().num_workers);
  const std::uint64_t bytes = memory_of_run(options_.limits);
  std::optional<ThinLayers> thin;
  if (sizes.thin == Thin::kKeep) thin = find_thin_layers(image_, sizes, sizes.delta_mm, loop_threads_);
  const Problem problem{
      .isosurface = *isosurface_,
      .object = object_,
      .delta_mm = sizes.delta_mm,
      .sizes = *size_field_,
      .cell_capacity = cell_capacity(bytes, num_workers, options_.team.executor, options_.log != nullptr),
      .memory_bytes = bytes,
      .dihedral_bounds = dihedral_bounds(),
      .deltas = thin ? thin->deltas.graded() : nullptr,
      .thin = thin ? &*thin : nullptr,
      .lines = lines_.get(),
      .lines_delta_mm = options_.lines.delta_mm > 0 ? options_.lines.delta_mm : kLinesDelta * sizes.delta_mm,
      .box_curves = box_curves_ ? &*box_curves_ : nullptr,
      .observe_perturbation = [&](double fraction, std::uint64_t cells) {
        announce("perturb", fraction, cells);
      }};
  refine(problem, team_.team(), stop_control);
}

std::optional<DihedralBounds> PhasesOfRun::dihedral_bounds() const {
  if (options_.min_dihedral_deg == 0) return std::nullopt;
  return DihedralBounds(options_.min_dihedral_deg, max_dihedral_deg(options_.min_dihedral_deg));
}

void PhasesOfRun::report_refinement(Refinement& refinement, MeshingReport& report) const {
  report.radius_mm = sizes_.radius_mm;
  report.delta_mm = sizes_.delta_mm;
  report.size_image_factor = sizes_.image_factor;
  report.phases_s.merge(refinement.phases_s);
  report.stop_reason = refinement.stop_reason;
  report.counters = refinement.counters;
  report.workers = refinement.workers;
  report.store_cells = refinement.mesh->num_cells();
  const auto& [low, high] = refinement.mesh->box();
  report.virtual_box = {low.x, low.y, low.z, high.x, high.y, high.z};
  const bool is_on_clock = VirtualThreads::current() != nullptr;  // its times are virtual already
  if (options_.team.executor == Executor::kVirtual && !is_on_clock) simulate(refinement, report);
  report.num_leaves = refinement.num_leaves;
  report.schedule = std::move(refinement.schedule);
  report.perturbation = refinement.perturbation;
  report.topology = std::move(refinement.topology);
  team_.report_to(report, std::move(refinement.pages));
}

// Phases whose loops run on this machine's threads take virtual time according to their counted work.
void PhasesOfRun::simulate(const Refinement& refinement, MeshingReport& report) const {
  const Team team = team_.team();
  const std::uint64_t voxels = image_.voxels.size(), cells = refinement.mesh->num_cells();
  const int num_workers = team.coordination.num_workers;
  report.virtual_phases_s = refinement.virtual_phases_s;
  report.virtual_phases_s["read"] = virtual_seconds(team, reading_voxels(voxels));
  report.virtual_phases_s["transform"] = virtual_seconds(team, transforming_voxels(voxels), num_workers);
  report.virtual_phases_s["extract"] = virtual_seconds(team, extracting_cells(cells), num_workers);
  report.virtual_model = time_model_text(costs_of(team));
  if (!options_.team.cost_factor.empty()) report.virtual_model += options_.team.cost_factor + "\n";
  const VirtualSpending& spending = refinement.virtual_spending;
  report.virtual_worker_s = {{"compute", spending.work_s},
                             {"memory_remote", spending.remote_memory_s},
                             {"network_queue", spending.network_s},
                             {"between_attempts", spending.between_s},
                             {"locks", spending.queueing_s}};
  for (const Cause& cause : kCauses)
    report.virtual_worker_s[cause.name] = refinement.counters.overhead.*cause.member;
}

void PhasesOfRun::optimize(Mesh& mesh, MeshingReport& report) const {
  const OptimizeOptions& asked = options_.optimize;
  if (!asked.is_wanted || report.stop_reason != StopReason::kComplete) return;
  announce("optimize", 0, 0);
  const double start_s = seconds_();
  label_cells(mesh, *isosurface_, loop_threads_);
  StopControl stop(
      {.max_elements = 0, .max_seconds = options_.limits.max_seconds}, stop_, [](std::uint64_t) {}, start_);
  const DihedralBounds bounds(asked.dihedral_bounds_deg[0], asked.dihedral_bounds_deg[1]);
  const OptimizerParameters parameters{OptimizationQuality(aim_over(bounds)), bounds, *size_field_,
                                       sizes_.delta_mm};
  try {
    report.optimization = optimize_mesh(mesh, parameters, team_.team(), stop,
                                        [&](double fraction) { announce("optimize", fraction, 0); });
    report.stop_reason = stop.reason();
  } catch (const std::bad_alloc&) {  // nothing has changed yet
    report.stop_reason = StopReason::kMemoryLimit;
  }
  report.phases_s["optimize"] = seconds_() - start_s;
}

// Perturbation and optimisation may have changed the topology.
void PhasesOfRun::compare_topology(Mesh& mesh, MeshingReport& report) const {
  if (!report.topology) return;
  if (report.perturbation || report.optimization) {
    const double start_s = seconds_();
    label_cells(mesh, *isosurface_, loop_threads_);
    compare_again(mesh, image_, *report.topology);
    report.phases_s["measure"] += seconds_() - start_s;
  }
  report.guarantees.topology = report.topology->differences.size();
}

MeshLines PhasesOfRun::extract_lines(const Refinement& refinement, MeshingReport& report) const {
  if (refinement.line_edges == nullptr) return {};
  label_cells(*refinement.mesh, *isosurface_, loop_threads_);
  return podm::extract_lines(*refinement.mesh, *refinement.line_edges, image_, report.lines.emplace());
}

void PhasesOfRun::extract(const std::function<void(Space)>& extract, MeshingReport& report) const {
  announce("extract", 0, 0);
  const double start_s = seconds_();
  return_free_memory();  // makes the workers' memory available to the mesh
  extract(options_.space == Space::kVoxel ? Space::kRas : options_.space);
  report.phases_s["extract"] += seconds_() - start_s;
}

void PhasesOfRun::finish(TetMesh& mesh, MeshingReport& report) const {
  announce("measure", 0, 0);
  const double start_s = seconds_();
  measure_quality(mesh, image_, *size_field_, loop_threads_, report);
  report.phases_s["measure"] += seconds_() - start_s;
  report.cells_mended_by_turning = mesh.num_mended_by_turning;
  // Moves of vertices, and the conversion to voxels, come after the test.
  if (mesh.num_mended_by_turning > 0 || options_.space == Space::kVoxel)
    report.is_delaunay_when_turned = report.is_delaunay_when_turned ? std::optional(false) : std::nullopt;
  mesh.is_optimized = report.optimization.has_value() || !report.is_delaunay_when_turned.value_or(true);
  mesh.smoothing_mm = options_.smoothing_mm;
  if (mesh.is_box_flat) report.facets_of_sides = count_facets_of_sides(mesh);
  if (report.topology) mesh.topology_differences = report.topology->differences;
  if (report.lines) mesh.lines.are_claimed = report.lines->is_claimed();
  promise_dihedral_bounds(mesh, report);
  if (options_.space != Space::kVoxel) return;
  const double begin_s = seconds_();
  convert_to_voxel_space(mesh, image_, loop_threads_);
  report.phases_s["extract"] += seconds_() - begin_s;
}

// Angles differ in voxel space.
void PhasesOfRun::promise_dihedral_bounds(TetMesh& mesh, MeshingReport& report) const {
  if (options_.space == Space::kVoxel) return;
  mesh.dihedral_bounds_deg = report.promised_dihedral_deg = dihedral_bounds_kept(report);
}

}  // namespace podm
