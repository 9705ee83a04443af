// The report of a run and its mesh.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "podm/bounds.h"
#include "podm/box_sides.h"
#include "podm/choices.h"
#include "podm/counters.h"
#include "podm/lines_report.h"
#include "podm/perturbation_report.h"
#include "podm/topology_report.h"

namespace podm {

/// Counts of cells and boundary facets that miss a guarantee. All are zero when StopReason is kComplete.
struct Guarantees {
  std::uint64_t radius_edge = 0;  ///< cells with radius-edge >= kRadiusEdgeBound
  /// Boundary facets with an angle <= kFacetAngleBound; near lines, <= asin(1/sqrt(8)), which exceeds
  /// kFacetAngleBoundNearLines.
  std::uint64_t facet_angle = 0;
  std::uint64_t radius = 0;          ///< cells with circumradius > r_t
  std::uint64_t facet_vertices = 0;  ///< boundary facets with a vertex off the isosurface
  /// Cells that became flat or inverted when coordinates were rounded for output.
  std::uint64_t orientation = 0;
  std::uint64_t missing_labels = 0;  ///< labels of more than 1000 voxels without a cell
  /// Differences of topology from the image that are left, if thin layers are kept.
  std::uint64_t topology = 0;
  /// Facets where the object leaves a flat box, and that do not lie on the side there.
  std::uint64_t off_sides = 0;
  bool all_met() const {
    return radius_edge + facet_angle + radius + facet_vertices + orientation + missing_labels + topology +
               off_sides ==
           0;
  }
};

/// Extremes over the output mesh, measured on the output coordinates (before a voxel-space transform).
struct Quality {
  double max_radius_edge = 0;
  double min_facet_angle_deg = 0, max_facet_angle_deg = 0;
  double min_dihedral_deg = 0, max_dihedral_deg = 0;
  double max_radius_mm = 0, shortest_edge_mm = 0;
};

/// One worker: its place and its work.
struct WorkerReport {
  int node = 0, socket = 0;      ///< its place in the machine (this one or the described one)
  std::optional<int> processor;  ///< the requested processor, by the system's number; unset: not bound
  std::optional<int> bound_to;   ///< the processor that the system reported when the worker had begun
  Counters counters;
};

/// The memory pages whose place the system reported at the ends of phases.
struct PageSamples {
  /// Page counts of one array, by comparison with the node that owns the memory. The owner of cells and
  /// vertices is the node whose worker made them. The owner of image and transform is the node that had them
  /// first.
  struct OfArray {
    std::string array;  ///< cells, vertices, image, transform
    std::uint64_t as_claimed = 0, elsewhere = 0;
    std::uint64_t untouched = 0;  ///< pages that are not in any node's memory yet
  };
  struct AtPhase {
    std::string phase;
    std::vector<OfArray> arrays;
    /// A sample of the workers' accesses, by the number of hops to the page.
    std::vector<std::uint64_t> accesses_by_hops;
  };
  std::vector<AtPhase> phases;
  std::string unavailable;  ///< reason why the system was not asked
};

/// The search for the radius of a target number of cells: an estimate from the image, then whole meshes until
/// one meets the target.
struct Calibration {
  std::uint64_t target_elements = 0;
  double radius_mm = 0;  ///< the radius found
  struct TrialMesh {
    double radius_mm = 0;
    std::uint64_t cells = 0;
    double seconds = 0;
  };
  /// Made and dropped, in this order; does not include the returned mesh.
  std::vector<TrialMesh> meshes;
  double seconds = 0;  ///< duration of the whole search: phases_s["calibrate"]
};

/// The leaves of an octree and the time at which each was refined.
struct LeafSchedule {
  std::array<double, 3> origin_mm{};  ///< origin of the grid, working frame
  double side_mm = 0;                 ///< side of a grid cell
  struct Leaf {
    std::array<std::uint32_t, 3> corner;  ///< its lowest grid cell
    std::uint32_t side;
  };
  std::vector<Leaf> leaves;
  struct Activation {
    std::uint32_t leaf, node;
    double begin_s, end_s;  ///< since the first activation; in virtual time under Executor::kVirtual
    std::uint64_t operations, deferred;
    std::vector<std::uint32_t> touched_leaves;  ///< leaves with a vertex that was locked
  };
  std::vector<Activation> activations;  ///< in the order of their ends
};

/// The effect of optimisation on the cells of the mesh, except background cells.
struct OptimizationReport {
  double least_dihedral_deg = 0, largest_dihedral_deg = 0;  ///< requested bounds
  double least_aim_deg = 0, largest_aim_deg = 0;            ///< angles that the optimiser aims at
  /// Cells beyond the aims, including those beyond the bounds.
  std::uint64_t beyond_aim_before = 0, beyond_aim = 0;
  std::uint64_t beyond_bounds_before = 0, beyond_bounds = 0;
  /// Reasons of the cells that remain beyond the bounds.
  std::map<OptimizationObstacle, std::uint64_t> obstacles;
  std::map<OptimizationMeans, std::uint64_t> successes;  ///< operations that improved cells
};

/// The effect of smoothing on the image, by label.
struct SmoothingReport {
  double width_mm = 0;
  struct OfLabel {
    std::uint32_t value = 0;
    /// Volume of its voxels, and volume within its smoothed interfaces.
    double voxels_mm3 = 0, smoothed_mm3 = 0;
    /// Numbers of components; faces join voxels.
    std::uint64_t voxels_components = 0, smoothed_components = 0;
    bool is_thin = false;  ///< the whole width would have lost most of it, so narrower widths were used
  };
  std::vector<OfLabel> labels;  ///< all labels except the background
};

struct MeshingReport {
  /// Seconds per phase of the returned mesh. "smooth" if smoothing was requested; "trace" and
  /// "lines" if lines are kept: they are traced, and sampled and mended; "transform"; "allocate":
  /// store, pools, workers and threads; "initial", "octree", "refine", "closing" (kPodm and kPodmHome have
  /// only "refine"); "mend" if thin layers are kept; "perturb" if R7 was requested; "optimize"; "extract";
  /// "measure": quality and guarantees. "calibrate" is the whole search for the radius of a target.
  std::map<std::string, double> phases_s;
  double radius_mm = 0;                    ///< the radius used; 0 when unbounded
  double delta_mm = 0;                     ///< the delta used
  double size_image_factor = 1;            ///< factor of all radii of the size image
  std::optional<Calibration> calibration;  ///< set if the target was a number of cells
  StopReason stop_reason = StopReason::kComplete;
  Guarantees guarantees;
  Quality quality;
  Counters counters;  ///< sum over all workers
  std::vector<WorkerReport> workers;
  int num_nodes = 1;                       ///< NUMA nodes of the machine
  Algorithm algorithm = Algorithm::kPodm;  ///< the algorithm used
  int computing_nodes = 1;                 ///< the number used
  std::uint64_t num_leaves = 0;
  std::optional<SmoothingReport> smoothing;        ///< set if smoothing was requested
  std::optional<OptimizationReport> optimization;  ///< set if the mesh was optimised
  /// Least and largest dihedral angle that all cells keep and the file promises, degrees. Set if R7 or
  /// optimisation was requested for these bounds and reached them, and the mesh is in mm.
  std::optional<std::array<double, 2>> promised_dihedral_deg;
  std::optional<LeafSchedule> schedule;
  PageSamples pages;
  std::string image_reads_unavailable;  ///< reason why HopsByKind lacks reads of the image; otherwise empty
  std::map<std::uint32_t, std::uint64_t> cells_of_label;  ///< by label value
  std::map<std::uint32_t, double> volume_of_label_mm3;    ///< volume in the mesh, by label value
  std::uint64_t store_cells = 0;                          ///< cells of the whole virtual box
  std::array<double, 6> virtual_box{};                    ///< low and high corner, mm, working frame
  /// Simulated seconds by phase under Executor::kVirtual, including "read"; otherwise empty.
  std::map<std::string, double> virtual_phases_s;
  /// Simulated seconds that all workers together spent on refinement, by use.
  std::map<std::string, double> virtual_worker_s;
  /// The constants of virtual time and the version of their model, one per line, for hashing.
  std::string virtual_model;
  /// The described machine whose costs virtual time charged, if any, and its unmeasured constants.
  struct SimulatedMachine {
    std::string name;
    std::map<std::string, double> constants;
  };
  std::optional<SimulatedMachine> simulated_machine;
  /// Facets by side of the box, set if it is flat.
  std::optional<std::array<std::uint64_t, kNumSides>> facets_of_sides;
  /// Set if the box is flat in an oblique frame: the mesh is turned for output. False if a vertex is inside
  /// the circumsphere of a cell in the coordinates of the file, or if that could not be excluded.
  std::optional<bool> is_delaunay_when_turned;
  std::uint64_t cells_mended_by_turning = 0;       ///< cells that rounding had inverted
  std::optional<TopologyReport> topology;          ///< set if thin layers are kept
  std::optional<LinesReport> lines;                ///< set if lines are kept
  std::optional<PerturbationReport> perturbation;  ///< set if R7 was requested and reached
  std::vector<std::string> warnings;
};

}  // namespace podm
