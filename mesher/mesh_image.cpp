// The public API: the phases of a run, one after the other.
#include "podm/mesh_image.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>

#include "algorithms/memory_model.h"
#include "algorithms/podm.h"
#include "algorithms/team_of_run.h"
#include "calibrate.h"
#include "check_options.h"
#include "cost_model.h"
#include "default_sizes.h"
#include "extract_mesh.h"
#include "measure_quality.h"
#include "podm/operation_log.h"
#include "replay.h"
#include "workers/work_cost.h"

namespace podm {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
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
        team_(options),
        loop_threads_(loop_threads(options.team)) {}

  MeshingResult operator()() {
    announce("transform", 0, 0);
    const Clock::time_point start = Clock::now();
    const Isosurface isosurface(image_, loop_threads_);
    MeshingResult result;
    MeshingReport& report = result.report;
    object_ = foreground_bounds(image_, loop_threads_);
    expected_cells_ = estimate(image_, options_).cells;
    report.phases_s["transform"] = seconds_since(start);
    team_.locate_memory(image_, isosurface.transform());
    Refinement refinement = refine(isosurface, report);
    report_refinement(refinement, report);
    extract(isosurface, refinement, result);
    measure(result);
    if (options_.space == Space::kVoxel) convert(result);
    return result;
  }

 private:
  void announce(const char* phase, double fraction, std::uint64_t cells) const {
    if (progress_) progress_({phase, std::clamp(fraction, 0.0, 1.0), cells, seconds_since(start_)});
  }

  Refinement refine(const Isosurface& isosurface, MeshingReport& report) {
    if (options_.sizes.target_elements > 0) {
      const auto make_mesh = [&](const SizeOptions& sizes) { return refine_with(isosurface, sizes); };
      return refine_to_target(image_, isosurface, options_.sizes, loop_threads_, make_mesh, report);
    }
    SizeOptions sizes = options_.sizes;
    sizes.delta_mm = delta_mm_for(image_, sizes);
    return refine_with(isosurface, sizes);
  }

  Refinement refine_with(const Isosurface& isosurface, const SizeOptions& sizes) {
    sizes_ = sizes;
    const auto observe = [&](std::uint64_t cells) {
      announce("refine", static_cast<double>(cells) / expected_cells_, cells);
    };
    StopControl stop_control(options_.limits, stop_, observe, start_);
    if (options_.log != nullptr) options_.log->restart();
    team_.forget_reads();
    announce("refine", 0, 0);
    const auto num_workers = static_cast<std::uint64_t>(team_.size().num_workers);
    const std::uint64_t bytes = memory_of_run(options_.limits);
    const Problem problem{.isosurface = isosurface,
                          .object = object_,
                          .delta_mm = sizes.delta_mm,
                          .sizes = size_field(image_, sizes),
                          .cell_capacity = cell_capacity(bytes, num_workers, options_.team.executor),
                          .memory_bytes = bytes};
    const Team team = team_.team();
    switch (team_.size().algorithm) {
      case Algorithm::kPdr:
        return pdr(problem, team, options_.leaves, stop_control);
      case Algorithm::kPdrPodm:
        return pdr_podm(problem, team, options_.leaves, stop_control);
      case Algorithm::kPodmHome:
        return podm_home(problem, team, stop_control);
      default:
        return podm(problem, team, stop_control);
    }
  }

  void report_refinement(Refinement& refinement, MeshingReport& report) const {
    report.radius_mm = sizes_.radius_mm;
    report.delta_mm = sizes_.delta_mm;
    report.phases_s.merge(refinement.phases_s);
    report.stop_reason = refinement.stop_reason;
    report.counters = refinement.counters;
    report.workers = refinement.workers;
    report.store_cells = refinement.mesh->num_cells();
    const auto& [low, high] = refinement.mesh->box();
    report.virtual_box = {low.x, low.y, low.z, high.x, high.y, high.z};
    if (options_.team.executor == Executor::kVirtual) simulate(refinement, report);
    report.num_leaves = refinement.num_leaves;
    report.schedule = std::move(refinement.schedule);
    team_.report_to(report, std::move(refinement.pages));
  }

  // Phases whose loops run on this machine's threads take virtual time by their counted work.
  void simulate(const Refinement& refinement, MeshingReport& report) const {
    const Team team = team_.team();
    const auto voxels = static_cast<double>(image_.voxels.size());
    const auto cells = static_cast<double>(refinement.mesh->num_cells());
    const int num_workers = team.coordination.num_workers;
    report.virtual_phases_s = refinement.virtual_phases_s;
    report.virtual_phases_s["read"] = virtual_seconds(team, kVoxelRead * voxels);
    report.virtual_phases_s["transform"] = virtual_seconds(team, kVoxelTransformed * voxels, num_workers);
    report.virtual_phases_s["extract"] = virtual_seconds(team, kCellExtracted * cells, num_workers);
    const VirtualSpending& spending = refinement.virtual_spending;
    report.virtual_worker_s = {{"compute", spending.work_s},
                               {"memory_remote", spending.remote_memory_s},
                               {"network_queue", spending.network_s},
                               {"between_attempts", spending.between_s},
                               {"locks", spending.queueing_s}};
    for (const Cause& cause : kCauses)
      report.virtual_worker_s[cause.name] = refinement.counters.overhead.*cause.member;
  }

  void extract(const Isosurface& isosurface, Refinement& refinement, MeshingResult& result) {
    announce("extract", 0, 0);
    const Clock::time_point start = Clock::now();
    malloc_trim(0);  // what workers had is for the mesh now
    MeshingReport& report = result.report;
    const Space space = options_.space == Space::kVoxel ? Space::kRas : options_.space;  // for now
    result.mesh =
        extract_mesh(*refinement.mesh, isosurface, space, loop_threads_, report.guarantees.facet_vertices);
    refinement.mesh.reset();
    report.phases_s["extract"] += seconds_since(start);
  }

  // The mesh is in mm.
  void measure(MeshingResult& result) const {
    announce("measure", 0, 0);
    const Clock::time_point start = Clock::now();
    measure_quality(result.mesh, image_, size_field(image_, sizes_), loop_threads_, result.report);
    result.report.phases_s["measure"] = seconds_since(start);
  }

  void convert(MeshingResult& result) const {
    const Clock::time_point start = Clock::now();
    convert_to_voxel_space(result.mesh, image_, loop_threads_);
    result.report.phases_s["extract"] += seconds_since(start);
  }

  const LabelImage& image_;
  const MeshingOptions& options_;
  const ProgressCallback& progress_;
  std::stop_token stop_;
  TeamOfRun team_;
  const int loop_threads_;
  SizeOptions sizes_;  // the last mesh has these
  Box object_{};       // bounds of the foreground
  double expected_cells_ = 1;
  const Clock::time_point start_ = Clock::now();
};

}  // namespace

MeshingResult mesh_image(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress, std::stop_token stop) {
  check_options(image, options);
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
