// The phases of a run that the runs on one machine and on ranks share. Refinement is done on one machine
// (mesh_image.cpp) or by a rank (distributed/mesh_image_on_ranks.cpp).
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "algorithms/podm.h"
#include "algorithms/team_of_run.h"
#include "isosurface/isosurface.h"
#include "lines/trace_lines.h"
#include "podm/mesh_image.h"

namespace podm {

class PhasesOfRun {
 public:
  /// A clock that times the phases, in seconds.
  using Seconds = std::function<double()>;
  static double seconds_on_the_wall();

  /// `share_of_cells` is the part of the mesh's cells that is expected in this process. Image, options and
  /// callback must outlive the object. Throws InputError if the machine cannot run the team.
  PhasesOfRun(const LabelImage& image, const MeshingOptions& options, const ProgressCallback& progress,
              std::stop_token stop, double share_of_cells = 1, Seconds seconds = seconds_on_the_wall);

  /// The first phase, which all other phases need. make() returns the isosurface of the image whose voxels
  /// have these weights; null: all weights are 1.
  using MakeIsosurface =
      std::function<std::shared_ptr<const Isosurface>(std::shared_ptr<const VoxelWeights>)>;
  void transform(MeshingReport& report, const MakeIsosurface& make);
  void transform(MeshingReport& report);
  const Isosurface& isosurface() const { return *isosurface_; }
  const TeamOfRun& team() const { return team_; }
  /// The sampling distance of surfaces, mm, unless a target number of elements determines it.
  double delta_mm() const { return expected_.delta_mm; }
  /// The number of cells that are expected in all processes together.
  double expected_cells() const { return expected_.cells; }
  int loop_threads() const { return loop_threads_; }

  /// Calls refine() with the problem of these sizes, in which delta is not 0. Only the last call is reported.
  using Refine = std::function<void(const Problem&, const Team&, StopControl&)>;
  void refine(const SizeOptions& sizes, const Refine& refine);
  void report_refinement(Refinement& refinement, MeshingReport& report) const;

  /// Improves the refined mesh, if that is requested and refinement was not ended early.
  void optimize(Mesh& mesh, MeshingReport& report) const;

  /// Compares the finished mesh with the image if thin layers are kept.
  void compare_topology(Mesh& mesh, MeshingReport& report) const;

  /// Returns the edges of lines in the mesh, with vertices by their ids in the store; none unless lines are
  /// kept.
  MeshLines extract_lines(const Refinement& refinement, MeshingReport& report) const;
  /// Calls extract(space), which must make the mesh in mm.
  void extract(const std::function<void(Space)>& extract, MeshingReport& report) const;
  /// Measures the mesh and converts it from mm to the requested space.
  void finish(TetMesh& mesh, MeshingReport& report) const;
  /// Promises the requested dihedral bounds if the report's quality keeps them. finish() does, too.
  void promise_dihedral_bounds(TetMesh& mesh, MeshingReport& report) const;

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<DihedralBounds> dihedral_bounds() const;
  std::shared_ptr<const VoxelWeights> smooth(MeshingReport& report) const;
  void trace(const std::shared_ptr<const VoxelWeights>& weights, MeshingReport& report);
  LineNetwork traced(const VoxelWeights* weights, LineOptions options) const;
  void announce(const char* phase, double fraction, std::uint64_t cells) const;
  void simulate(const Refinement& refinement, MeshingReport& report) const;

  const LabelImage& image_;
  const MeshingOptions& options_;
  const ProgressCallback& progress_;
  std::stop_token stop_;
  TeamOfRun team_;
  const int loop_threads_;
  const double share_of_cells_;
  const Seconds seconds_;
  std::shared_ptr<const Isosurface> isosurface_;
  std::unique_ptr<const Lines> lines_;          // null: no lines are kept
  std::optional<LineNetwork> box_curves_;       // none: the box is open
  SizeOptions sizes_;                           // sizes of the last mesh
  std::optional<SizeField> size_field_;         // size field of the last mesh
  std::shared_ptr<const SizeGrid> asked_grid_;  // of the requested sizes
  Box object_{};                                // bounds of the foreground
  Estimate expected_;                           // over all processes
  const Clock::time_point start_ = Clock::now();
};

}  // namespace podm
