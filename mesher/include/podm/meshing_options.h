// The options of a run. A new option needs a member here, with its default, and a line in
// cli/options/add_mesh_options.cpp, whose help reads the default. A line in cli/reports/record.cpp writes it
// to records, and algorithms/check_options.cpp refuses senseless values.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "podm/choices.h"
#include "podm/limits.h"
#include "podm/size_image.h"

namespace podm {

class OperationLogWriter;

/// A bound on the cells whose circumcenter is within a width of the interface between two sets of labels. The
/// interface here consists of the faces between their voxels. Labels are given by value; the background has
/// its own value.
struct SizeNear {
  std::array<std::vector<std::uint32_t>, 2> labels;  ///< one or more labels on either side
  double radius_mm = 0;                              ///< largest circumradius, mm
  double width_mm = 0;                               ///< largest distance from the interface, mm
};

/// The sizes of cells. The least bound that applies at a cell's circumcenter limits the cell.
struct SizeOptions {
  /// Largest circumradius r_t of a cell, mm. 0: unbounded, only the surface drives refinement.
  double radius_mm = 0;
  /// r_t of single labels by label *value*, mm; overrides `radius_mm`.
  std::map<std::uint32_t, double> radius_of_mm = {};
  /// Local radii; null: none.
  std::shared_ptr<const SizeImage> image = nullptr;
  /// Factor of all radii of the image. A target number of elements determines the factor itself.
  double image_factor = 1;
  std::vector<SizeNear> near = {};
  /// Largest growth of bounds, mm per mm of distance. 0: unlimited. Distances are measured over voxels: a
  /// bound is the largest that grows no faster from voxel to voxel, or up to an eighth of the growth less
  /// where voxels are cubes (sizing/graded_grid.h).
  double grade = 0;
  /// Surface sampling distance, mm. 0: default_delta_mm() of the least radius. Local sizes count with their
  /// largest bound, if every place has one.
  double delta_mm = 0;
  /// If positive, the mesher chooses radius_mm, which must be 0, for a mesh of about this number of cells.
  /// The image's factor is then such that its largest radius in the object is the same.
  std::uint64_t target_elements = 0;
  /// Largest deviation of the number of cells from the target, percent of the target.
  double target_tolerance_percent = 5;
};

/// The workers of a run. The mesher chooses numbers that are 0.
struct TeamOptions {
  /// Threads of all phases. With one thread the same input gives a bitwise equal mesh; with more threads it
  /// gives a mesh with the same guarantees. Default: nodes times cores per node if these are given, otherwise
  /// one for refinement; all cores for the other phases.
  int threads = 0;
  /// Computing nodes of kPdrPodm and kPodmHome; default: NUMA nodes in use; for kPdr one per thread.
  int nodes = 0;
  int cores_per_node = 0;   ///< threads of each computing node; default: threads / nodes
  int initial_threads = 0;  ///< threads of the initial mesh of kPdr and kPdrPodm; default: all
  Contention contention = Contention::kLocal;
  Begging begging = Begging::kHierarchical;
  std::string pin = "none";    ///< compact, scatter, none, or a list of processors: runtime/placement.h
  bool oversubscribe = false;  ///< false: more threads than processors are refused
  /// The machine that the workers represent, as hwloc XML, or as TOML with its costs (NAME.toml:
  /// runtime/machine_model.h). Empty: this machine.
  std::string topology_path = {};
  /// Multiplies one constant of that machine in virtual time, to measure its influence: "NAME=FACTOR",
  /// runtime/cost_factor.h. Empty: none.
  std::string cost_factor = {};
  Executor executor = Executor::kThreads;
  VirtualCost virtual_cost = VirtualCost::kMeasured;
  std::uint64_t seed = 1;  ///< determines pauses of Contention::kRandom, and virtual time
};

/// The division of space by kPdr and kPdrPodm.
struct LeafOptions {
  /// Circumradius bound and delta of the initial mesh, relative to those of the final mesh.
  double initial_ratio = 4;
  double size_mm = 0;          ///< side of the octree's leaves; 0: from the initial mesh's bound
  bool with_schedule = false;  ///< the report lists when each leaf was refined
};

/// The optimisation of the finished mesh, which is no longer Delaunay afterwards. A run that ends early skips
/// it.
struct OptimizeOptions {
  bool is_wanted = false;
  /// Bounds on dihedral angles, degrees. The optimiser aims at one and a half times these bounds, where a
  /// cell's neighbours allow it.
  double least_dihedral_deg = 8, largest_dihedral_deg = 165;
};

struct MeshingOptions {
  SizeOptions sizes = {};
  /// Degrees. If positive, vertices move at the end of the run, to reduce the number of cells with a dihedral
  /// angle below it or above max_dihedral_deg() of it (rule R7). All guarantees are kept. The angle itself is
  /// not guaranteed: the report counts the remaining cells; if there is none, the file promises the angle.
  double min_dihedral_deg = 0;
  /// If positive, labels are blurred by a Gaussian of this width, mm. Interfaces are then where blurred
  /// labels tie, not on the stairs of voxels. Voxels keep their labels.
  double smoothing_mm = 0;
  Space space = Space::kRas;
  Algorithm algorithm = Algorithm::kPodm;
  /// kAuto runs kPodmHome from this number of threads on. 0: it does so if threads are pinned, with the same
  /// number on each of several NUMA nodes. In simulation kPodmHome is then faster for meshes that are large
  /// enough for the threads (experiments/simulated_weak.toml).
  int crossover = 0;
  TeamOptions team = {};
  LeafOptions leaves = {};
  OptimizeOptions optimize = {};
  std::uint64_t cut_seed = 0;  ///< on ranks: draws the cuts between blocks; 0: cuts follow the predicted work
  Limits limits = {};
  OperationLogWriter* log = nullptr;  ///< receives every operation of the last run; the caller finishes it
};

}  // namespace podm
