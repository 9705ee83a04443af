// What a run tells of itself and of its mesh.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "podm/bounds.h"
#include "podm/choices.h"
#include "podm/counters.h"
#include "podm/perturbed.h"

namespace podm {

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

/// One worker: where it was, and what it did.
struct WorkerReport {
  int node = 0, socket = 0;      ///< where it stood in the machine, this or the described one
  std::optional<int> processor;  ///< the one asked for, by the system's number; none: bound to none
  std::optional<int> bound_to;   ///< the system told so when the worker had begun
  Counters counters;
};

/// Pages that the system was asked about, at the ends of phases.
struct PageSamples {
  /// Pages are compared with the node that owns the memory: the one whose worker made the cells and
  /// vertices, and the one that had image and transform first.
  struct OfArray {
    std::string array;  ///< cells, vertices, image, transform
    std::uint64_t as_claimed = 0, elsewhere = 0;
    std::uint64_t untouched = 0;  ///< they are in nobody's memory yet
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
  double seconds = 0;  ///< all this took: phases_s["calibrate"]
};

/// The leaves of an octree and when each was refined.
struct LeafSchedule {
  std::array<double, 3> origin_mm{};  ///< where the grid begins, working frame
  double side_mm = 0;                 ///< a grid cell's
  struct Leaf {
    std::array<std::uint32_t, 3> corner;  ///< its lowest cell of the grid
    std::uint32_t side;
  };
  std::vector<Leaf> leaves;
  struct Activation {
    std::uint32_t leaf, node;
    double begin_s, end_s;  ///< since the first; in virtual time under Executor::kVirtual
    std::uint64_t operations, deferred;
    std::vector<std::uint32_t> touched_leaves;  ///< that hold a vertex which was locked
  };
  std::vector<Activation> activations;  ///< the first to end comes first
};

/// What optimisation did to the cells of the mesh; those of the background are not among them.
struct OptimizationReport {
  double least_dihedral_deg = 0, largest_dihedral_deg = 0;  ///< the bounds asked for
  double least_aim_deg = 0, largest_aim_deg = 0;            ///< what was aimed at
  /// Cells beyond what was aimed at, those beyond the bounds among them.
  std::uint64_t beyond_aim_before = 0, beyond_aim = 0;
  std::uint64_t beyond_bounds_before = 0, beyond_bounds = 0;
  std::map<OptimizationObstacle, std::uint64_t> obstacles;  ///< of the cells that are beyond the bounds
  std::map<OptimizationMeans, std::uint64_t> successes;     ///< operations that made cells better
};

/// What smoothing made of the image, by label.
struct SmoothingReport {
  double width_mm = 0;
  struct OfLabel {
    std::uint32_t value = 0;
    double voxels_mm3 = 0,
           smoothed_mm3 = 0;  ///< the volume of its voxels, and within its smoothed interfaces
    std::uint64_t voxels_components = 0, smoothed_components = 0;  ///< the same; of voxels by their faces
    bool is_thin = false;  ///< the whole width would have lost most of it: narrower ones were taken
  };
  std::vector<OfLabel> labels;  ///< but the background
};

struct MeshingReport {
  /// Seconds of the mesh that is returned. "smooth" where that was asked for; "transform"; "allocate": store,
  /// pools, workers and threads made ready; "initial", "octree", "refine", "closing" (of kPodm and kPodmHome
  /// "refine" alone); "perturb" where R7 was asked for; "optimize"; "extract"; "measure": quality and
  /// guarantees. And "calibrate": all that finding the radius of a target cost.
  std::map<std::string, double> phases_s;
  double radius_mm = 0;                    ///< the one used; 0 when unbounded
  double delta_mm = 0;                     ///< the one used
  double size_image_factor = 1;            ///< that of all its radii
  std::optional<Calibration> calibration;  ///< there is one where a number of cells was the target
  StopReason stop_reason = StopReason::kComplete;
  Guarantees guarantees;
  Quality quality;
  Counters counters;  ///< all workers'
  std::vector<WorkerReport> workers;
  int num_nodes = 1;                       ///< NUMA nodes of the machine
  Algorithm algorithm = Algorithm::kPodm;  ///< the one used
  int computing_nodes = 1;                 ///< the number used
  std::uint64_t num_leaves = 0;
  std::optional<SmoothingReport> smoothing;        ///< there is one where that was asked for
  std::optional<OptimizationReport> optimization;  ///< there is one of a mesh that was optimised
  /// Least and largest dihedral angle that all cells keep, as the file promises, if R7 or optimisation were
  /// asked for that and reached it, and the mesh is in mm.
  std::optional<std::array<double, 2>> promised_dihedral_deg;
  std::optional<LeafSchedule> schedule;
  PageSamples pages;
  std::string image_reads_unavailable;  ///< why HopsByKind lacks reads of the image; otherwise empty
  std::map<std::uint32_t, std::uint64_t> cells_of_label;  ///< by label value
  std::map<std::uint32_t, double> volume_of_label_mm3;    ///< the mesh's, by label value
  std::uint64_t store_cells = 0;                          ///< cells of the whole virtual box
  std::array<double, 6> virtual_box{};                    ///< its low and high corner, mm, working frame
  /// Simulated seconds by phase under Executor::kVirtual, "read" among them; else none.
  std::map<std::string, double> virtual_phases_s;
  /// Simulated seconds of all workers together while they refine, by what they went into.
  std::map<std::string, double> virtual_worker_s;
  /// The constants by which virtual time went, with their model's version: a line each, for hashing.
  std::string virtual_model;
  /// The described machine whose costs virtual time charged, if any, and its constants that nobody measures.
  struct SimulatedMachine {
    std::string name;
    std::map<std::string, double> constants;
  };
  std::optional<SimulatedMachine> simulated_machine;
  std::optional<Perturbed> perturbed;  ///< there is one where R7 was asked for, and reached
  std::vector<std::string> warnings;
};

}  // namespace podm
