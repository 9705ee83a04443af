// The whole public API of the mesher: a label image in, a tetrahedral mesh with guarantees out.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "podm/choices.h"
#include "podm/errors.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm {

/// Radius-edge bound of every output cell: circumradius / shortest edge < kRadiusEdgeBound.
/// sqrt(2 + sqrt(3)) = 1.93185 in the proof; the published bound 1.93 is kept, see refine/rules.h for what
/// that costs.
inline constexpr double kRadiusEdgeBound = 1.93;
/// Every planar angle of every boundary facet exceeds this, in degrees.
inline constexpr double kFacetAngleBound = 30.0;

/// Threads from which on kAuto is kPdrPodm, unless told: the crossover of the published runs lies between 128
/// and 160 cores (Feng et al., IMR 2015, Table 1). An experiment measures it for the machine at hand.
inline constexpr int kDefaultCrossover = 144;

class OperationLogWriter;
struct OperationLog;

struct MeshingOptions {
  /// Largest circumradius r_t of a cell, mm. 0: unbounded, the surface alone drives.
  double radius_mm = 0;
  /// r_t of single labels by label *value*, mm; these override `radius_mm`.
  std::map<std::uint32_t, double> radius_of_mm;
  /// Surface sampling distance, mm. 0: default_delta_mm().
  double delta_mm = 0;
  /// When positive: choose radius_mm so that the mesh has this many cells within 5 %; radius_mm must be 0.
  std::uint64_t target_elements = 0;
  Space space = Space::kRas;
  Algorithm algorithm = Algorithm::kPodm;
  int crossover = kDefaultCrossover;  ///< threads from which on kAuto is kPdrPodm
  // Of PDR and PDR.PODM; 0: left to the mesher.
  int nodes = 0;             ///< computing nodes; default: NUMA nodes in use, for kPdr one a thread
  int cores_per_node = 0;    ///< threads of each; default: threads over nodes
  double initial_ratio = 4;  ///< circumradius bound and delta of the initial mesh over those of the final one
  int initial_threads = 0;   ///< of the initial mesh; default: all
  double leaf_size_mm = 0;   ///< side of the octree's leaves; default: from the initial mesh's bound
  bool with_schedule = false;  ///< report when which leaf was refined
  /// Of all phases. With one thread the same input makes the same mesh to the bit, with more one of the same
  /// guarantees. 0: one for refinement, all cores for the rest.
  int threads = 0;
  Contention contention = Contention::kLocal;
  Begging begging = Begging::kHierarchical;
  std::string pin = "none";    ///< compact, scatter, none, or processors: runtime/placement.h
  bool oversubscribe = false;  ///< else more threads than processors are refused
  std::string topology_path;   ///< hwloc XML of the machine that the workers stand for; empty: this one
  Executor executor = Executor::kThreads;
  VirtualCost virtual_cost = VirtualCost::kMeasured;
  std::uint64_t seed = 1;             ///< of pauses of Contention::kRandom and of virtual time
  OperationLogWriter* log = nullptr;  ///< learns of every operation of the last run; not finished
  // Limits end the run with a valid Delaunay mesh that says what is unmet. 0: none.
  std::uint64_t max_elements = 0;
  double max_seconds = 0;
  std::uint64_t max_memory_bytes = 0;  ///< beside image and transform

  /// Of all phases but refinement: the threads of virtual time are none of this machine's.
  int loop_threads() const { return executor == Executor::kVirtual ? 0 : threads; }
};

/// The most cells of a mesh while it is made, those of the background among them: facets have numbers of 32
/// bits.
inline constexpr std::uint64_t kMostStoredCells = (std::uint64_t{1} << 30) - 1;

/// What a run is expected to cost, from the image and the options alone.
struct Estimate {
  double cells = 0;
  double memory_bytes = 0;  ///< peak of the whole process
};

struct Progress {
  std::string phase;        ///< "transform", "refine", "extract", "measure"
  double fraction = 0;      ///< of the phase, an estimate in [0,1]
  std::uint64_t cells = 0;  ///< so far
  double seconds = 0;       ///< since the start of the run
};
/// Called from the meshing thread a few times a second.
using ProgressCallback = std::function<void(const Progress&)>;

/// Cells and boundary facets that miss a guarantee; all zero when StopReason is kComplete.
struct Guarantees {
  std::uint64_t radius_edge = 0;     ///< cells with radius-edge >= kRadiusEdgeBound
  std::uint64_t facet_angle = 0;     ///< boundary facets with an angle <= kFacetAngleBound
  std::uint64_t radius = 0;          ///< cells with circumradius > r_t
  std::uint64_t facet_vertices = 0;  ///< boundary facets with a vertex off the isosurface
  std::uint64_t orientation = 0;     ///< cells that rounding to output coordinates made flat or turned over
  std::uint64_t missing_labels = 0;  ///< labels of more than 1000 voxels without a cell
  bool all_met() const {
    return radius_edge + facet_angle + radius + facet_vertices + orientation + missing_labels == 0;
  }
};

/// Extremes over the output, measured on the output coordinates (before a voxel-space transform).
struct Quality {
  double max_radius_edge = 0;
  double min_facet_angle_deg = 0, max_facet_angle_deg = 0;
  double min_dihedral_deg = 0, max_dihedral_deg = 0;
  double max_radius_mm = 0, shortest_edge_mm = 0;
};

/// Accesses to memory, by the hops from the worker's NUMA node to the one that owns the memory. Empty on one
/// node.
struct HopsByKind {
  std::vector<std::uint64_t> mesh_reads;   ///< cells tested, vertices locked; owned by whose worker made them
  std::vector<std::uint64_t> mesh_writes;  ///< cells and vertices that filling and gluing wrote; likewise
  std::vector<std::uint64_t> image_reads;  ///< labels of the image, one or some of a row at a time
  std::vector<std::uint64_t> transform_reads;  ///< words of the feature transform
};

/// Operations by outcome and work done, exact counts.
struct Counters {
  std::array<std::uint64_t, 5> insertions_by_rule{};  ///< R1..R5
  std::uint64_t removals = 0;                         ///< vertices removed by R6
  std::uint64_t rejected = 0;                         ///< operations that broke the spacing floor
  std::uint64_t stale_cells = 0;                      ///< poor element list entries that had died
  std::uint64_t classified_cells = 0;
  std::uint64_t conflict_tests = 0;
  std::uint64_t exact_decisions = 0;  ///< conflict tests that the cached sphere left undecided
  std::uint64_t cells_created = 0;
  std::uint64_t lock_conflicts = 0;  ///< attempts rolled back
  std::uint64_t out_of_leaf = 0;     ///< attempts that needed vertices outside a leaf's region, deferred
  std::uint64_t region_cells = 0;    ///< cells that operations collected to replace, carried out or not
  // Seconds lost, of all workers.
  double contention_s = 0, begging_s = 0, rollback_s = 0;
  HopsByKind hops;
};

/// One worker: where it was, and what it did.
struct WorkerReport {
  int node = 0, socket = 0;      ///< of the machine, or of the one described
  std::optional<int> processor;  ///< asked for, by the system's number; none: bound to none
  std::optional<int> bound_to;   ///< as the system told when the worker had begun
  Counters counters;
};

/// Pages that the system was asked about, at the ends of phases.
struct PageSamples {
  /// Against the node that owns the memory: of cells, their states and vertices the node whose worker made
  /// them, of image and transform the node that had them first.
  struct OfArray {
    std::string array;  ///< cells, cell_states, vertices, image, transform
    std::uint64_t as_claimed = 0, elsewhere = 0;
    std::uint64_t untouched = 0;  ///< in nobody's memory yet
  };
  struct AtPhase {
    std::string phase;
    std::vector<OfArray> arrays;
    /// A sample of the workers' accesses, by the hops to where the page is.
    std::vector<std::uint64_t> accesses_by_hops;
  };
  std::vector<AtPhase> phases;
  std::string unavailable;  ///< why none were asked
};

/// How the radius for a target number of cells was found: from the image, and from whole meshes that missed.
struct Calibration {
  std::uint64_t target_elements = 0;
  double radius_mm = 0;  ///< found
  struct TrialMesh {
    double radius_mm = 0;
    std::uint64_t cells = 0;
    double seconds = 0;
  };
  std::vector<TrialMesh>
      meshes;          ///< made and dropped, in this order; the mesh that is returned is not among them
  double seconds = 0;  ///< of all this: phases_s["calibrate"]
};

/// The leaves of an octree and when each was refined.
struct LeafSchedule {
  std::array<double, 3> origin_mm{};  ///< of the grid, working frame
  double side_mm = 0;                 ///< of a grid cell
  struct Leaf {
    std::array<std::uint32_t, 3> corner;  ///< in the grid
    std::uint32_t side;
  };
  std::vector<Leaf> leaves;
  struct Activation {
    std::uint32_t leaf, node;
    double begin_s, end_s;  ///< since the first; in virtual time under Executor::kVirtual
    std::uint64_t operations, deferred;
    std::vector<std::uint32_t> touched_leaves;  ///< that hold a vertex which was locked
  };
  std::vector<Activation> activations;  ///< in the order of their ends
};

struct MeshingReport {
  /// Seconds of the mesh that is returned. "transform"; "allocate": store, pools, workers and threads made
  /// ready; "initial", "octree", "refine", "closing" (of kPodm "refine" alone); "extract"; "measure": quality
  /// and guarantees. And "calibrate": all that finding the radius of a target cost.
  std::map<std::string, double> phases_s;
  double radius_mm = 0;                    ///< as used; 0 when unbounded
  double delta_mm = 0;                     ///< as used
  std::optional<Calibration> calibration;  ///< of a target number of cells
  StopReason stop_reason = StopReason::kComplete;
  Guarantees guarantees;
  Quality quality;
  Counters counters;  ///< of all workers
  std::vector<WorkerReport> workers;
  int num_nodes = 1;                       ///< NUMA nodes of the machine
  Algorithm algorithm = Algorithm::kPodm;  ///< as used
  int computing_nodes = 1;                 ///< as used
  std::uint64_t num_leaves = 0;
  std::optional<LeafSchedule> schedule;
  PageSamples pages;
  std::string image_reads_unavailable;  ///< why HopsByKind lacks reads of the image; otherwise empty
  std::map<std::uint32_t, std::uint64_t> cells_of_label;  ///< by label value
  std::map<std::uint32_t, double> volume_of_label_mm3;    ///< by label value, of the mesh
  std::uint64_t store_cells = 0;                          ///< cells of the whole virtual box
  std::array<double, 6> virtual_box{};                    ///< its low and high corner, mm, working frame
  /// Of Executor::kVirtual: simulated seconds of initial, refine and closing.
  std::map<std::string, double> virtual_phases_s;
  std::vector<std::string> warnings;
};

struct MeshingResult {
  TetMesh mesh;
  MeshingReport report;
};

/// Default surface sampling distance for an image and a radius (mm; radius 0: unbounded), mm.
double default_delta_mm(const LabelImage& image, double radius_mm);

/// Expected cells and memory of mesh_image with these options (target_elements resolved).
Estimate estimate(const LabelImage& image, const MeshingOptions& options);

/// Meshes `image`. Throws InputError on bad options or an image without foreground, std::bad_alloc when
/// memory runs out. A stop request or a limit ends the run early with a valid mesh; see stop_reason.
/// Rules and proofs: Foteinos, Chernikov, Chrisochoides, CGTA 47 (2014) 539-562.
MeshingResult mesh_image(const LabelImage& image, const MeshingOptions& options,
                         const ProgressCallback& progress = {}, std::stop_token stop = {});

/// The mesh that the logged operations make one after the other: the serial run that a parallel run claims to
/// equal. Throws InputError, naming the operation, when one cannot be carried out as logged.
TetMesh replay_operations(const LabelImage& image, const OperationLog& log, Space space);

}  // namespace podm
