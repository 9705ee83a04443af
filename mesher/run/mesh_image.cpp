// The public API: runs the phases one after another.
#include "podm/mesh_image.h"

#include "algorithms/check_options.h"
#include "replay/replay.h"
#include "run/calibrate.h"
#include "run/delaunay_when_turned.h"
#include "run/extract_mesh.h"
#include "run/facets_of_sides.h"
#include "run/phases_of_run.h"
#include "smoothing/smooth_interfaces.h"

namespace podm {

namespace {

// One call of mesh_image().
class Run {
 public:
  Run(const LabelImage& image, const MeshingOptions& options, const ProgressCallback& progress,
      std::stop_token stop)
      : image_(image), options_(options), phases_(image, options, progress, std::move(stop)) {}

  MeshingResult operator()() {
    MeshingResult result;
    MeshingReport& report = result.report;
    phases_.transform(report);
    Refinement refinement = refine(report);
    phases_.report_refinement(refinement, report);
    phases_.optimize(*refinement.mesh, report);
    phases_.compare_topology(*refinement.mesh, report);
    report.guarantees.off_sides =
        count_facets_off_sides(*refinement.mesh, phases_.isosurface(), phases_.loop_threads());
    const auto extract = [&](Space space) {
      MeshLines lines = phases_.extract_lines(refinement, report);
      if (is_turned_for_output(image_)) {
        label_cells(*refinement.mesh, phases_.isosurface(), phases_.loop_threads());
        report.is_delaunay_when_turned =
            !report.optimization && is_delaunay_when_turned(*refinement.mesh, image_, phases_.loop_threads());
      }
      result.mesh = extract_mesh(*refinement.mesh, phases_.isosurface(), space, phases_.loop_threads(),
                                 report.guarantees.facet_vertices, {}, std::move(lines));
      refinement.mesh.reset();
    };
    phases_.extract(extract, report);
    phases_.finish(result.mesh, report);
    return result;
  }

 private:
  Refinement refine(MeshingReport& report) {
    if (options_.sizes.target_elements > 0) return refine_to_target(report);
    SizeOptions sizes = options_.sizes;
    sizes.delta_mm = phases_.delta_mm();
    return refine_with(sizes);
  }

  Refinement refine_to_target(MeshingReport& report) {
    Refinement refinement;
    const auto make = [&](const SizeOptions& sizes) {
      refinement = {};  // frees the memory of the mesh before
      refinement = refine_with(sizes);
      return refinement.stop_reason;
    };
    const auto count_cells = [&] {
      return label_cells(*refinement.mesh, phases_.isosurface(), phases_.loop_threads());
    };
    const auto begin = [&] { return RadiusSearch(image_, options_.sizes, phases_.loop_threads()); };
    podm::refine_to_target(options_.sizes, {begin, make, count_cells, PhasesOfRun::seconds_on_the_wall},
                           report);
    return refinement;
  }

  Refinement refine_with(const SizeOptions& sizes) {
    Refinement refinement;
    phases_.refine(sizes, [&](const Problem& problem, const Team& team, StopControl& stop) {
      refinement = refine_by(phases_.team().size().algorithm, problem, team, options_.leaves, stop);
    });
    return refinement;
  }

  const LabelImage& image_;
  const MeshingOptions& options_;
  PhasesOfRun phases_;
};

}  // namespace

MeshingResult mesh_image(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress, std::stop_token stop) {
  check_options(image, options);
  return Run(image, options, progress, std::move(stop))();
}

TetMesh replay_operations(const LabelImage& image, const OperationLog& log, Space space) {
  check_voxels(image);
  const std::unique_ptr<Mesh> refined = replay(log);
  const Isosurface isosurface(image, 0, weights_of(image, log.head.smoothing_mm, 0));
  std::uint64_t facets_off_isosurface = 0;
  const bool is_voxel = space == Space::kVoxel;
  TetMesh mesh = extract_mesh(*refined, isosurface, is_voxel ? Space::kRas : space, 0, facets_off_isosurface);
  if (is_voxel) convert_to_voxel_space(mesh, image, 0);
  return mesh;
}

}  // namespace podm
