// The parts of programs' records that this program reads: a mesher's record of a mesh (podm mesh --record,
// and peers by harness/peers/README.md), and the record of the machine by `podm-bench latency`. Parts that
// are not read are kept unchanged.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "rows/fields.h"

namespace podm::bench {

inline constexpr int kMesherSchema = 1;
inline constexpr const char* kComplete = "complete";  ///< stop reason of a run that met no limit

/// The verdict of podm-verify on a claim. Only kPass counts as proved.
enum class Proof { kPass, kFail, kNotRun };
constexpr std::array<const char*, 3> names_of(Proof) { return {"pass", "fail", "not_run"}; }

using Count = std::variant<std::uint64_t, Unavailable>;
using Measured = std::variant<double, Unavailable>;
using Hops = std::variant<std::vector<std::uint64_t>, Unavailable>;  ///< accesses at 0, 1, ... hops

/// The file that a mesher read.
struct InputOfMesher {
  std::optional<std::string> path, sha256;
  std::optional<std::vector<std::vector<double>>> affine;  ///< rows of the matrix from voxels to mm
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(InputOfMesher, (path), (sha256), (affine)); }
};

struct UsedSizes {
  std::optional<double> radius_mm, size_image_factor, delta_mm;
  JsonPointer as_written;
  static constexpr auto fields() {
    return PODM_FIELDS(UsedSizes, (radius_mm), (size_image_factor), (delta_mm));
  }
};

struct ThreadsRecord {
  std::optional<int> asked, used;
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(ThreadsRecord, (asked), (used)); }
};

/// Times of virtual workers.
struct VirtualRecord {
  std::optional<double> refine_s;
  std::optional<ByName<double>> phases_s;  ///< of eq. (1)
  std::optional<ByName<double>> worker_s;  ///< seconds of all workers during refinement, by cause
  /// Hash of the constants and rules of virtual time; absent in older rows.
  std::optional<std::string> model_sha256;
  JsonPointer as_written;
  static constexpr auto fields() {
    return PODM_FIELDS(VirtualRecord, (refine_s), (phases_s), (worker_s), (model_sha256));
  }
};

/// Attempts at operations by outcome.
struct OutcomesRecord {
  std::optional<std::uint64_t> committed, lock_conflict, out_of_leaf;
  JsonPointer as_written;
  static constexpr auto fields() {
    return PODM_FIELDS(OutcomesRecord, (committed), (lock_conflict), (out_of_leaf));
  }
};

/// Seconds lost by all workers together, by cause.
struct OverheadRecord {
  std::optional<double> contention, begging, rollback;
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(OverheadRecord, (contention), (begging), (rollback)); }
};

/// The work that made the mesh, in numbers that one thread repeats exactly.
struct WorkRecord {
  std::optional<ByName<std::uint64_t>> insertions;  ///< by rule
  std::optional<std::uint64_t> removals, classified_cells, conflict_tests, exact_decisions, cells_created;
  JsonPointer as_written;
  static constexpr auto fields() {
    return PODM_FIELDS(WorkRecord, (insertions), (removals), (classified_cells), (conflict_tests),
                       (exact_decisions), (cells_created));
  }
};

/// Seconds of a rank in one phase: processor seconds outside of collectives, and seconds in collectives.
struct SpentRecord {
  double computing_s = 0, waiting_s = 0, network_s = 0;
  static constexpr auto fields() { return PODM_FIELDS(SpentRecord, computing_s, waiting_s, network_s); }
};

struct RankRecord {
  std::uint64_t cells = 0;
  std::optional<std::uint64_t> store_cells;    ///< with those that other ranks have, too
  std::optional<std::uint64_t> seed_vertices;  ///< inserted before round 0
  ByName<SpentRecord> spent;
  JsonPointer as_written;
  static constexpr auto fields() {
    return PODM_FIELDS(RankRecord, cells, (store_cells), (seed_vertices), spent);
  }
};

/// Vertices that all ranks learn at once.
struct UpdateRecord {
  std::uint64_t inserted = 0;
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(UpdateRecord, inserted); }
};

/// A round of all ranks.
struct RoundRecord {
  std::uint64_t deferred = 0;          ///< cells
  std::optional<UpdateRecord> update;  ///< before the round
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(RoundRecord, deferred, (update)); }
};

/// The ranks as podm-mpi reports them.
struct RanksRecord {
  std::uint64_t number = 0;
  double imbalance = 1;  ///< largest number of cells of a rank over the mean
  std::vector<RoundRecord> rounds;
  std::optional<UpdateRecord> last_update;  ///< after all rounds
  std::vector<RankRecord> by_rank;
  JsonPointer as_written;
  static constexpr auto fields() {
    return PODM_FIELDS(RanksRecord, number, imbalance, rounds, (last_update), by_rank);
  }
};

/// Cells with a dihedral angle out of bounds, by whether a vertex of theirs is free.
struct PoorCellsRecord {
  std::uint64_t with_free_vertex = 0, without = 0;
  static constexpr auto fields() { return PODM_FIELDS(PoorCellsRecord, with_free_vertex, without); }
};

/// The effect of moving vertices (R7) on dihedral angles.
struct PerturbedRecord {
  double min_dihedral_deg = 0, max_dihedral_deg = 0;  ///< the bounds
  PoorCellsRecord before, after;
  ByName<std::uint64_t> unmoved;  ///< cells of `after`, by reason
  static constexpr auto fields() {
    return PODM_FIELDS(PerturbedRecord, min_dihedral_deg, max_dihedral_deg, before, after, unmoved);
  }
};

/// The effect of optimisation on dihedral angles: numbers of cells beyond the aim and beyond the bounds.
struct OptimizationRecord {
  double least_aim_deg = 0, largest_aim_deg = 0;
  std::uint64_t beyond_aim_before = 0, beyond_aim = 0, beyond_bounds_before = 0, beyond_bounds = 0;
  ByName<std::uint64_t> obstacles;  ///< of the cells beyond the bounds
  ByName<std::uint64_t> successes;  ///< operations that improved cells, by kind
  static constexpr auto fields() {
    return PODM_FIELDS(OptimizationRecord, least_aim_deg, largest_aim_deg, beyond_aim_before, beyond_aim,
                       beyond_bounds_before, beyond_bounds, obstacles, successes);
  }
};

/// Dihedral angles of all cells, in degrees, as podm-verify counts them.
struct DihedralRecord {
  double least = 0, largest = 0;
  std::vector<std::uint64_t> counts;  ///< one bin per degree, from 0; six angles per cell
  static constexpr auto fields() { return PODM_FIELDS(DihedralRecord, least, largest, counts); }
};

/// Compares the labels of a mesh with those of its image: counts labels whose number of components, and
/// labels whose Euler number, is that of the image under one of its two connectivities or lies between the
/// two.
struct TopologyRecord {
  std::uint64_t labels = 0, components_as_image = 0, euler_as_image = 0;
  static constexpr auto fields() {
    return PODM_FIELDS(TopologyRecord, labels, components_as_image, euler_as_image);
  }
};

/// The lines of a mesh made with --lines.
struct LinesRecord {
  double traced_mm = 0, kept_mm = 0;
  double share_kept = 0;  ///< kept_mm over traced_mm
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(LinesRecord, traced_mm, kept_mm, share_kept); }
};

/// A difference of topology that is left in a mesh made with --thin keep.
struct DifferenceRecord {
  std::string kind;
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(DifferenceRecord, kind); }
};

struct ThinLayersRecord {
  std::vector<DifferenceRecord> differences;
  JsonPointer as_written;
  static constexpr auto fields() { return PODM_FIELDS(ThinLayersRecord, differences); }
};

/// One way between the lines of image and mesh: the share that has lines of the other within the bound.
struct LineWayRecord {
  double share_near = 0;
  std::optional<double> furthest_mm;  ///< unset if the other has no line of some labels
  static constexpr auto fields() { return PODM_FIELDS(LineWayRecord, share_near, furthest_mm); }
};

/// Distances between the lines of image and mesh. The bound of `share_near` is half of `lines_delta_mm`.
struct LineDistancesRecord {
  double lines_delta_mm = 0;
  std::uint64_t line_edges = 0;
  double length_mm = 0;  ///< of the mesh's lines
  LineWayRecord image_to_mesh, mesh_to_image;
  static constexpr auto fields() {
    return PODM_FIELDS(LineDistancesRecord, lines_delta_mm, line_edges, length_mm, image_to_mesh,
                       mesh_to_image);
  }
};

/// The inputs of podm-verify beside the mesh and the image: claims, and options with their
/// bounds.
struct JudgingRecord {
  std::vector<std::string> claims, options;
  static constexpr auto fields() { return PODM_FIELDS(JudgingRecord, claims, options); }
};

/// A mesher's record of a mesh.
struct MeshRecord {
  std::optional<int> schema;           ///< kMesherSchema; a row has its own member instead
  std::optional<InputOfMesher> input;  ///< a row has its own member instead
  std::optional<std::string> mesh;     ///< file of a peer's mesh
  std::optional<std::string> algorithm;
  JsonPointer options;  ///< the requested options, by the mesher's own keys
  std::optional<UsedSizes> used;
  std::optional<JudgingRecord> verify;  ///< rows of before November 2026 have none
  std::optional<std::uint64_t> seed;
  std::optional<ThreadsRecord> threads;
  std::optional<VirtualRecord> virtual_time;
  std::optional<RanksRecord> ranks;
  ByName<double> phases_s;
  std::uint64_t cells = 0, vertices = 0;
  std::optional<std::uint64_t> boundary_facets;
  std::optional<std::uint64_t> surface_cells;  ///< part of `cells`, made in phase `surface`
  std::optional<double> cells_per_second;
  double refine_cells_per_second = 0;
  std::optional<OutcomesRecord> outcomes;
  std::optional<OverheadRecord> overhead_s;
  std::optional<Hops> hops;
  std::optional<std::variant<ByName<Hops>, Unavailable>> hops_by_kind;
  std::optional<WorkRecord> counters;
  std::optional<PerturbedRecord> perturbed;
  std::optional<OptimizationRecord> optimization;
  std::optional<std::array<double, 2>> promised_dihedral_deg;  ///< least and largest angle; unset: none
  ByName<std::uint64_t> guarantees;                            ///< misses of each guarantee
  std::optional<std::string> mesh_sha256;
  std::optional<ByName<Proof>> verdicts;              ///< one per claim; unset if podm-verify did not run
  std::optional<DihedralRecord> dihedral_deg;         ///< unset if podm-verify did not report it
  std::optional<TopologyRecord> topology;             ///< unset if podm-verify had no image
  std::optional<LinesRecord> lines;                   ///< unset without --lines
  std::optional<ThinLayersRecord> thin_layers;        ///< unset without --thin keep
  std::optional<LineDistancesRecord> line_distances;  ///< unset if the trial does not ask for them
  /// Largest distance of a boundary vertex from the plane of its side, in units in the last place of the
  /// box's largest coordinate. Unset if podm-verify did not judge a flat box.
  std::optional<double> box_ulps_off;
  /// Largest distance of the mesh's interfaces from the image's. Unset if podm-verify did not measure it.
  std::optional<double> interface_distance_mm;
  std::optional<std::vector<std::string>> promises;  ///< promised claims; unset: all
  std::string stop_reason;
  JsonPointer as_written;
  static constexpr auto fields() {
    return std::tuple_cat(
        PODM_FIELDS(MeshRecord, (schema), (input), (mesh), (algorithm), (options), (used), (verify), (seed),
                    (threads)),
        std::tuple{field_if_any("virtual", &MeshRecord::virtual_time)},
        PODM_FIELDS(MeshRecord, (ranks), phases_s, cells, vertices, (boundary_facets), (surface_cells),
                    (cells_per_second), refine_cells_per_second, (outcomes), (overhead_s), (hops),
                    (hops_by_kind), (counters), (perturbed), (optimization), (promised_dihedral_deg),
                    guarantees, (mesh_sha256), (verdicts), (dihedral_deg), (topology), (lines), (thin_layers),
                    (line_distances), (box_ulps_off), (interface_distance_mm), (promises), stop_reason));
  }
};

/// Returns the time of the paper's eq. (1) in seconds: all phases except those that make no part of the mesh,
/// results/README.md.
double meshing_seconds(const ByName<double>& phases_s);

/// Loads from one working set in the memory of a node.
struct LatencyRecord {
  std::uint64_t working_set_bytes = 0;
  int node = 0;
  double ns = 0, cycles = 0;   ///< of one load
  double huge_page_share = 0;  ///< share of the working set on huge pages
  static constexpr auto fields() {
    return PODM_FIELDS(LatencyRecord, working_set_bytes, node, ns, cycles, huge_page_share);
  }
};

/// A line of Table 3: a cache, or the memory of a node.
struct MemoryLevel {
  int level = 1;
  std::string module;  ///< "L1 cache", "memory of the own node 0"
  std::uint64_t size_bytes = 0;
  std::optional<std::uint64_t> working_set_bytes;
  std::optional<int> node;
  Measured ns, cycles;  ///< of one load
  std::optional<double> huge_page_share;
  std::optional<Measured> likwid_bench_cycles_per_line;
  static constexpr auto fields() {
    return PODM_FIELDS(MemoryLevel, level, module, size_bytes, (working_set_bytes), (node), ns, cycles,
                       (huge_page_share), (likwid_bench_cycles_per_line));
  }
};

/// The record of `podm-bench latency`: Table 3 for this machine.
struct MemoryLevelsRecord {
  int processor = 0;    ///< the processor that measured
  bool pinned = false;  ///< the thread was bound to it
  std::vector<MemoryLevel> memory_levels;
  std::vector<LatencyRecord> latency;  ///< one per working set, of all sizes
  static constexpr auto fields() {
    return PODM_FIELDS(MemoryLevelsRecord, processor, pinned, memory_levels, latency);
  }
};

}  // namespace podm::bench
