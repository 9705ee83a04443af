// What a run is asked for. A new option is a member here, with its default, and a line in
// cli/add_mesh_options.cpp, whose help reads the default. Records tell it by a line in cli/record.cpp, and
// check_options.cpp refuses what is senseless.
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

/// A bound on cells whose circumcentre is within a width of the interface of some labels and others: of the
/// faces between their voxels. Labels are given by value, the background by its own.
struct SizeNear {
  std::array<std::vector<std::uint32_t>, 2> labels;  ///< on either side, one or more
  double radius_mm = 0;                              ///< largest circumradius, mm
  double width_mm = 0;                               ///< mm
};

/// How large cells are: what bounds a cell at its circumcentre is the least of all that follows.
struct SizeOptions {
  /// Largest circumradius r_t of a cell, mm. 0: unbounded, the surface alone drives.
  double radius_mm = 0;
  /// r_t of single labels by label *value*, mm; these override `radius_mm`.
  std::map<std::uint32_t, double> radius_of_mm = {};
  /// Radii by place; null: none.
  std::shared_ptr<const SizeImage> image = nullptr;
  /// All of its radii are multiplied by this. With a target number of elements it follows from that.
  double image_factor = 1;
  std::vector<SizeNear> near = {};
  /// By how much bounds may grow, mm a mm of the way. 0: at once. Distances are those of voxels: a bound is
  /// the largest that grows no faster from voxel to voxel, or less by an eighth of the growth where voxels
  /// are cubes (image/graded_grid.h).
  double grade = 0;
  /// Surface sampling distance, mm. 0: default_delta_mm() of the least radius, that of places counting where
  /// it is bounded everywhere, by its largest.
  double delta_mm = 0;
  /// When positive: radius_mm, which must be 0, is chosen so that the mesh has about so many cells; and the
  /// factor of the image so that its largest radius in the object is the same.
  std::uint64_t target_elements = 0;
  /// How far from the target the number of cells may be, in percent of it.
  double target_tolerance_percent = 5;
};

/// Who refines. Numbers that are 0 are left to the mesher.
struct TeamOptions {
  /// Threads of all phases. With one the same input makes the same mesh to the bit, with more one of the same
  /// guarantees. Default: nodes times cores per node, where these are given, else one for refinement; all
  /// cores for the other phases.
  int threads = 0;
  /// Computing nodes of kPdrPodm and kPodmHome; default: NUMA nodes in use, for kPdr one a thread.
  int nodes = 0;
  int cores_per_node = 0;   ///< threads of each computing node; default: threads over nodes
  int initial_threads = 0;  ///< threads of the initial mesh of kPdr and kPdrPodm; default: all
  Contention contention = Contention::kLocal;
  Begging begging = Begging::kHierarchical;
  std::string pin = "none";    ///< compact, scatter, none, or processors: runtime/placement.h
  bool oversubscribe = false;  ///< else more threads than processors are refused
  /// The machine that the workers stand for, as hwloc XML or, with what it costs, as TOML (NAME.toml:
  /// runtime/machine_model.h). Empty: this one.
  std::string topology_path = {};
  /// A constant of that machine in virtual time, times a factor, to see what hangs on it: "NAME=FACTOR",
  /// runtime/cost_factor.h. Empty: none.
  std::string cost_factor = {};
  Executor executor = Executor::kThreads;
  VirtualCost virtual_cost = VirtualCost::kMeasured;
  std::uint64_t seed = 1;  ///< decides pauses of Contention::kRandom, and virtual time
};

/// How kPdr and kPdrPodm divide space.
struct LeafOptions {
  double initial_ratio = 4;  ///< circumradius bound and delta of the initial mesh over those of the final one
  double size_mm = 0;        ///< side of the octree's leaves; 0: from the initial mesh's bound
  bool with_schedule = false;  ///< the report tells when which leaf was refined
};

/// What happens to the finished mesh, which is no longer Delaunay then. A run that ends early is not
/// optimised.
struct OptimizeOptions {
  bool is_wanted = false;
  /// Bounds on dihedral angles, degrees. Half as much again is aimed at, of cells whose neighbours allow it.
  double least_dihedral_deg = 8, largest_dihedral_deg = 165;
};

struct MeshingOptions {
  SizeOptions sizes = {};
  /// Degrees. When positive: at the end vertices move so that fewer cells have a dihedral angle below it, or
  /// above max_dihedral_deg() of it (rule R7). All guarantees are kept, and this is none: the report tells
  /// what is left, and if nothing is the file promises it.
  double min_dihedral_deg = 0;
  /// When positive: interfaces lie where labels tie that are blurred by a Gaussian of this width, mm, instead
  /// of on the stairs of voxels. Voxels keep their labels.
  double smoothing_mm = 0;
  Space space = Space::kRas;
  Algorithm algorithm = Algorithm::kPodm;
  /// With fewer threads kPdrPodm and kAuto are exactly kPodm; from this number on kAuto is kPodmHome. 0:
  /// kPdrPodm has no threshold, and kAuto is kPodmHome where pins put equally many threads on each of several
  /// NUMA nodes. Other algorithms have none.
  int crossover = 0;
  TeamOptions team = {};
  LeafOptions leaves = {};
  OptimizeOptions optimize = {};
  std::uint64_t cut_seed = 0;  ///< on ranks: draws where blocks are cut; 0: by predicted work
  Limits limits = {};
  OperationLogWriter* log = nullptr;  ///< learns of every operation of the last run; not finished
};

}  // namespace podm
