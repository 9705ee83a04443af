// The phases of a run but refinement, which is one machine's (mesh_image.cpp) or a rank's
// (distributed/mesh_image_on_ranks.cpp), and what they share.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "algorithms/podm.h"
#include "algorithms/team_of_run.h"
#include "isosurface/isosurface.h"
#include "podm/mesh_image.h"

namespace podm {

class PhasesOfRun {
 public:
  /// A clock that phases are timed by, in seconds.
  using Seconds = std::function<double()>;
  static double seconds_on_the_wall();

  /// So much of the mesh's cells is expected in this process. Image, options and callback must outlive it.
  /// Throws InputError on a team that the machine cannot have.
  PhasesOfRun(const LabelImage& image, const MeshingOptions& options, const ProgressCallback& progress,
              std::stop_token stop, double share_of_cells = 1, Seconds seconds = seconds_on_the_wall);

  /// The first phase; all others need it. The isosurface is that of the image.
  void transform(MeshingReport& report, const std::function<std::shared_ptr<const Isosurface>()>& make);
  void transform(MeshingReport& report);
  const Isosurface& isosurface() const { return *isosurface_; }
  const TeamOfRun& team() const { return team_; }
  /// What surfaces are sampled at unless a target number of elements decides, mm.
  double delta_mm() const { return expected_.delta_mm; }
  int loop_threads() const { return loop_threads_; }

  /// Calls refine() with what these sizes ask for, in which delta is not 0. The last call is told of.
  using Refine = std::function<void(const Problem&, const Team&, StopControl&)>;
  void refine(const SizeOptions& sizes, const Refine& refine);
  void report_refinement(Refinement& refinement, MeshingReport& report) const;

  /// Betters the refined mesh, if that is asked for and refinement was not ended early.
  void optimize(Mesh& mesh, MeshingReport& report) const;

  /// Calls extract(space), which makes the mesh, in mm.
  void extract(const std::function<void(Space)>& extract, MeshingReport& report) const;
  /// Measures the mesh, and brings it from mm to the space that was asked for.
  void finish(TetMesh& mesh, MeshingReport& report) const;

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<DihedralBounds> dihedral_bounds() const;
  std::shared_ptr<const VoxelStrengths> smooth(MeshingReport& report) const;
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
  SizeOptions sizes_;                           // the last mesh has these
  std::optional<SizeField> size_field_;         // these
  std::shared_ptr<const SizeGrid> asked_grid_;  // of the sizes that were asked for
  Box object_{};                                // bounds of the foreground
  Estimate expected_;                           // of all processes together
  const Clock::time_point start_ = Clock::now();
};

}  // namespace podm
