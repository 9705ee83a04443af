// The options of a run. A new option is a member here, with its default, and a line in options(): see
// podm/option.h.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "podm/bounds.h"
#include "podm/choices.h"
#include "podm/limits.h"
#include "podm/option.h"
#include "podm/size_image.h"

namespace podm {

class OperationLogWriter;

inline constexpr int kMostThreads = 1024;
inline constexpr const char* kThinNotOnRanks =
    "the topologies of image and mesh are compared on a whole mesh";

inline constexpr const char* kLinesNotOnRanks =
    "vertices of a line are sampled before refinement, in one store";
/// The default sampling distance of lines over that of surfaces.
inline constexpr double kLinesDelta = 1.25;

/// A bound on the cells whose circumcenter is within a width of the interface between two sets of labels. The
/// interface here consists of the faces between their voxels. Labels are given by value; the background has
/// its own value.
struct InterfaceSize {
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
  std::vector<InterfaceSize> near = {};
  /// Largest growth of bounds, mm per mm of distance. 0: unlimited. Distances are measured over voxels: a
  /// bound is the largest that grows no faster from voxel to voxel, or up to an eighth of the growth less
  /// where voxels are cubes (sizing/graded_grid.h).
  double grade = 0;
  /// Surface sampling distance, mm. 0: default_delta_mm() of the least radius. Local sizes count with their
  /// largest bound, if every place has one.
  double delta_mm = 0;
  /// Layers of labels thinner than delta are kept or lost (sizing/thin_layers.h).
  Thin thin = Thin::kLose;
  /// The least delta anywhere if thin layers are kept, mm. 0: half of a voxel's shortest side.
  double delta_least_mm = 0;
  /// If positive, the mesher chooses radius_mm, which must be 0, for a mesh of about this number of cells.
  /// The image's factor is then such that its largest radius in the object is the same.
  std::uint64_t target_elements = 0;
  /// Largest deviation of the number of cells from the target, percent of the target.
  double target_tolerance_percent = 5;
  /// Largest number of meshes made for the target; 1: the first mesh is taken, whatever its number of cells.
  int target_meshes = 6;

  static constexpr auto options() {
    using S = SizeOptions;
    using enum OptionGroup;
    return std::tuple{
        option(&S::radius_mm, "radius", "MM", kSize, "upper bound on the circumradius of each cell, mm",
               {.unset = "unbounded, the surfaces alone decide",
                .record = "radius_mm",
                .uses = kInAll | kInPlan,
                .quantity = "length in mm"}),
        option(&S::delta_mm, "delta", "MM", kSize, "sampling distance of the surfaces, mm",
               {.unset = "from the voxel size and the radius",
                .record = "delta_mm",
                .uses = kInAll | kInPlan,
                .quantity = "length in mm"}),
        option(&S::thin, "thin", "", kSurfaces,
               "layers and gaps thinner than delta: keep them, with a delta that follows their\n"
               "thickness, compare the topology of each label with the image's, and refine where\n"
               "they differ; or lose them",
               {.record = "thin", .uses = kInAll | kInPlan, .not_on_ranks = kThinNotOnRanks}),
        option(&S::delta_least_mm, "delta-least", "MM", kSurfaces,
               "least sampling distance where thin layers are kept, mm",
               {.unset = "half of a voxel's shortest side",
                .record = "delta_least_mm",
                .uses = kInAll | kInPlan,
                .not_on_ranks = kThinNotOnRanks,
                .quantity = "length in mm",
                .needs = "thin"}),
        option(&S::target_elements, "target-elements", "N", kSize,
               "choose the radius, and the factor of --size-image, for this number of cells",
               {.unset = "none", .uses = kInAll | kInPlan, .excludes = "radius"}),
        option(&S::target_tolerance_percent, "target-tolerance", "PERCENT", kSize,
               "largest difference of the number of cells from the target, %",
               {.record = "target_tolerance_percent",
                .uses = kInAll | kInPlan,
                .most = 100,
                .quantity = "percentage",
                .needs = "target-elements"}),
        option(&S::target_meshes, "target-meshes", "N", kSize,
               "largest number of meshes made for the target; 1 takes the predicted radius",
               {.uses = kInPodm | kInPython, .most = 100, .needs = "target-elements"}),
        option(&S::grade, "grade", "G", kSize,
               "limit the growth of all bounds on sizes, of labels too, to G mm per mm",
               {.unset = "no limit", .uses = kInAll | kInPlan})};
  }
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
  std::uint64_t seed = 1;  ///< decides pauses of Contention::kRandom, and virtual time

  static constexpr auto options() {
    using T = TeamOptions;
    using enum OptionGroup;
    return std::tuple{
        option(&T::threads, "threads", "N", kRun, "threads of all phases; 1 makes the same mesh every time",
               {.unset = "one for refinement, all cores for the other phases",
                .uses = kInAll | kInPlan,
                .most = kMostThreads,
                .help_on_ranks =
                    "threads of each rank, in all phases; with 1 the same number of ranks makes the\n"
                    "same mesh every time",
                .unset_on_ranks = "processors over the ranks of the machine; 1 in process"}),
        option(&T::contention, "contention", "", kRun, "policy of a thread that meets another thread's lock"),
        option(&T::begging, "begging", "", kRun,
               "idle thread that gets work first: random (the first that asked) or\n"
               "hierarchical (the nearest in the machine)"),
        option(&T::executor, "executor", "", kRun,
               "threads; or virtual: one core plays any number of threads in virtual time,\n"
               "with the same result for the same seed; times are then simulated"),
        option(&T::pin, "pin", "PLAN", kRun,
               "bind threads to processors: compact, scatter, none,\n"
               "or processors such as 0,2,4-7"),
        option(&T::oversubscribe, "oversubscribe", "", kRun, "allow more threads than processors",
               {.unset = "refused", .uses = kInAll | kInPlan}),
        option(&T::nodes, "nodes", "N", kAlgorithm, "computing nodes of pdr-podm and podm-home",
               {.unset = "NUMA nodes in use", .most = kMostThreads}),
        option(&T::cores_per_node, "cores-per-node", "N", kAlgorithm, "threads of each computing node",
               {.unset = "threads over nodes", .most = kMostThreads}),
        option(&T::initial_threads, "initial-threads", "N", kAlgorithm,
               "threads that make the initial mesh of pdr and pdr-podm",
               {.unset = "all", .most = kMostThreads}),
        option(&T::seed, "seed", "N", kRun, "seed of the pauses after conflicts and of virtual time",
               {.least = 0,
                .help_on_ranks = "0: blocks of equal predicted work; otherwise the seed of where blocks are\n"
                                 "cut, of pauses, and of the order in which ranks in process compute",
                .unset_on_ranks = "0"}),
        option(&T::topology_path, "topology", "FILE", kRun,
               "machine that the threads stand for: hwloc XML, or TOML with its costs\n"
               "(NAME.toml, see experiments/machines)",
               {.unset = "this machine"}),
        option(&T::cost_factor, "cost-factor", "NAME=FACTOR", kRun,
               "multiply one constant of a machine in TOML by a factor; 0 switches it off.\n"
               "results/README.md lists the names",
               {.unset = "none"}),
        option(&T::virtual_cost, "virtual-cost", "", kRun,
               "virtual time of an attempt: unit (1 us) or measured (by its work)")};
  }
};

/// The division of space by kPdr and kPdrPodm.
struct LeafOptions {
  double initial_ratio = 4;  ///< circumradius bound and delta of the initial mesh over those of the final one
  double size_mm = 0;        ///< side of the octree's leaves; 0: from the initial mesh's bound
  bool with_schedule = false;  ///< the report lists when each leaf was refined

  static constexpr auto options() {
    using L = LeafOptions;
    using enum OptionGroup;
    return std::tuple{option(&L::initial_ratio, "initial-ratio", "X", kAlgorithm,
                             "bounds of the initial mesh of pdr and pdr-podm over\n"
                             "the final ones",
                             {.least = 1}),
                      option(&L::size_mm, "leaf-size", "MM", kAlgorithm, "side of the octree's leaves, mm",
                             {.unset = "from the bounds of the initial mesh", .quantity = "length in mm"})};
  }
};

/// The optimisation of the finished mesh, which is no longer Delaunay afterwards. A run that ends early skips
/// it.
struct OptimizeOptions {
  bool is_wanted = false;
  /// Least and largest dihedral angle, degrees. The aim is one and a half times as far from 0 and 180, where
  /// the neighbours of a cell allow it.
  std::array<double, 2> dihedral_bounds_deg{8, 165};

  static constexpr auto options() {
    using O = OptimizeOptions;
    using enum OptionGroup;
    return std::tuple{
        option(
            &O::is_wanted, "optimize", "", kDihedral,
            "improve the worst cells of the finished mesh; surfaces and all other bounds\n"
            "stay, but the mesh is no longer Delaunay",
            {.unset = "no", .uses = kInAll | kInPlan, .not_on_ranks = "optimisation works on a whole mesh"}),
        option(&O::dihedral_bounds_deg, "dihedral-bounds", "MIN,MAX", kDihedral,
               "least and largest dihedral angle of a cell, degrees; the aim is 3/2 of MIN, and\n"
               "4/3 as far below 180 as MAX; cells that stay beyond the bounds are counted",
               {.uses = kInAll | kInPlan,
                .not_on_ranks = "optimisation works on a whole mesh",
                .needs = "optimize"})};
  }
};

/// Lines where three or more labels meet.
struct LinesOptions {
  bool are_kept = false;  ///< lines become edges of the mesh
  double delta_mm = 0;    ///< their largest sampling distance, mm; 0: kLinesDelta times that of surfaces

  static constexpr auto options() {
    using L = LinesOptions;
    using enum OptionGroup;
    return std::tuple{
        option(
            &L::are_kept, "lines", "", kSurfaces,
            "make edges of the lines where three or more labels meet; facets with a vertex on\n"
            "a line have angles above 20.7 degrees, all others above 30; not with --thin keep\n"
            "or --optimize",
            {.unset = "edges cross these lines", .uses = kInAll | kInPlan, .not_on_ranks = kLinesNotOnRanks}),
        option(&L::delta_mm, "lines-delta", "MM", kSurfaces, "sampling distance of the lines, mm",
               {.unset = "1.25 times that of the surfaces",
                .record = "lines_delta_mm",
                .uses = kInAll | kInPlan,
                .not_on_ranks = kLinesNotOnRanks,
                .quantity = "length in mm",
                .needs = "lines"})};
  }
};

struct MeshingOptions {
  SizeOptions sizes = {};
  LinesOptions lines = {};
  /// Degrees. If positive, vertices move at the end of the run, to reduce the number of cells with a dihedral
  /// angle below it or above max_dihedral_deg() of it (rule R7). All guarantees are kept. The angle itself is
  /// not guaranteed: the report counts the remaining cells; if there is none, the file promises the angle.
  double min_dihedral_deg = 0;
  /// If positive, labels are blurred by a Gaussian of this width, mm. Interfaces are then where blurred
  /// labels tie, not on the stairs of voxels. Voxels keep their labels.
  double smoothing_mm = 0;
  /// The surface of objects that touch the image's border. It must agree with LabelImage::is_box_flat.
  BoxFaces box = BoxFaces::kOpen;
  Space space = Space::kRas;
  Algorithm algorithm = Algorithm::kPodm;
  /// With fewer threads kPdrPodm and kAuto are exactly kPodm; from this number on kAuto is kPodmHome. 0:
  /// kPdrPodm has no threshold, and kAuto is kPodmHome where pins put equally many threads on each of several
  /// NUMA nodes. Other algorithms have none.
  int crossover = 0;
  TeamOptions team = {};
  LeafOptions leaves = {};
  OptimizeOptions optimize = {};
  std::uint64_t cut_seed = 0;  ///< on ranks: draws the cuts between blocks; 0: cuts follow the predicted work
  Limits limits = {};
  OperationLogWriter* log = nullptr;  ///< learns of every operation of the last run; not finished

  static constexpr auto options() {
    using M = MeshingOptions;
    using enum OptionGroup;
    return std::tuple{
        option(&M::algorithm, "algorithm", "", kAlgorithm,
               "podm: all threads anywhere, with locks; pdr-podm: leaf by leaf of an octree,\n"
               "each by a node of several threads; pdr: leaf by leaf, one thread each, no locks;\n"
               "podm-home: podm by nodes of several threads, each in its own block of space;\n"
               "auto: podm, or podm-home on threads pinned to several NUMA nodes",
               {.uses = kInAll | kInPlan}),
        nested(&M::sizes),
        nested(&M::lines),
        nested(&M::team),
        nested(&M::leaves),
        option(&M::crossover, "crossover", "N", kAlgorithm,
               "number of threads below which pdr-podm and auto are exactly podm; from it\n"
               "on auto is podm-home",
               {.unset = "pdr-podm has none, auto follows NUMA nodes",
                .not_on_ranks = "ranks have threads of their own",
                .most = kMostThreads}),
        option(&M::smoothing_mm, "smooth", "MM", kSurfaces,
               "blur all labels with a Gaussian of this width, mm; interfaces lie where the two\n"
               "largest weights are equal, and voxels keep their labels; about 1.5 voxels;\n"
               "thin parts are blurred less",
               {.unset = "interfaces follow the voxels",
                .record = "smoothing_mm",
                .uses = kInAll | kInPlan,
                .quantity = "length in mm"}),
        option(&M::box, "box", "", kSurfaces,
               "surface of objects that touch the image's border: rounded there; or flat, in the\n"
               "planes of the outermost voxels' outer faces, whose edges are edges of the mesh",
               {.not_on_ranks = "a rank does not know on which side of the box the vertices of others are"}),
        option(&M::min_dihedral_deg, "min-dihedral", "DEG", kDihedral,
               "at the end move vertices until almost no cell with an interior vertex has a\n"
               "dihedral angle below this, degrees, or above 175 less 1.25 times this; all\n"
               "bounds are kept, and the mesh stays Delaunay",
               {.unset = "nothing moves",
                .record = "min_dihedral_deg",
                .uses = kInAll | kInPlan,
                .most = kMostMinDihedral,
                .quantity = "angle in degrees"}),
        nested(&M::optimize),
        nested(&M::limits),
        option(&M::space, "space", "", kOutput,
               "frame of the coordinates: RAS or LPS (mm), or voxel (indices)",
               {.uses = kInPodm | kOnRanks | kInPython})};
  }
};

}  // namespace podm
