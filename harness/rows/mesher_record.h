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
  static constexpr auto fields() {
    using I = InputOfMesher;
    return std::tuple{field_if_any("path", &I::path), field_if_any("sha256", &I::sha256),
                      field_if_any("affine", &I::affine)};
  }
};

struct UsedSizes {
  std::optional<double> radius_mm, size_image_factor, delta_mm;
  JsonPointer as_written;
  static constexpr auto fields() {
    return std::tuple{field_if_any("radius_mm", &UsedSizes::radius_mm),
                      field_if_any("size_image_factor", &UsedSizes::size_image_factor),
                      field_if_any("delta_mm", &UsedSizes::delta_mm)};
  }
};

struct ThreadsRecord {
  std::optional<int> asked, used;
  JsonPointer as_written;
  static constexpr auto fields() {
    return std::tuple{field_if_any("asked", &ThreadsRecord::asked),
                      field_if_any("used", &ThreadsRecord::used)};
  }
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
    return std::tuple{field_if_any("refine_s", &VirtualRecord::refine_s),
                      field_if_any("phases_s", &VirtualRecord::phases_s),
                      field_if_any("worker_s", &VirtualRecord::worker_s),
                      field_if_any("model_sha256", &VirtualRecord::model_sha256)};
  }
};

/// Attempts at operations by outcome.
struct OutcomesRecord {
  std::optional<std::uint64_t> committed, lock_conflict, out_of_leaf;
  JsonPointer as_written;
  static constexpr auto fields() {
    using O = OutcomesRecord;
    return std::tuple{field_if_any("committed", &O::committed),
                      field_if_any("lock_conflict", &O::lock_conflict),
                      field_if_any("out_of_leaf", &O::out_of_leaf)};
  }
};

/// Seconds lost by all workers together, by cause.
struct OverheadRecord {
  std::optional<double> contention, begging, rollback;
  JsonPointer as_written;
  static constexpr auto fields() {
    using O = OverheadRecord;
    return std::tuple{field_if_any("contention", &O::contention), field_if_any("begging", &O::begging),
                      field_if_any("rollback", &O::rollback)};
  }
};

/// The work that made the mesh, in numbers that one thread repeats exactly.
struct WorkRecord {
  std::optional<ByName<std::uint64_t>> insertions;  ///< by rule
  std::optional<std::uint64_t> removals, classified_cells, conflict_tests, exact_decisions, cells_created;
  JsonPointer as_written;
  static constexpr auto fields() {
    using W = WorkRecord;
    return std::tuple{field_if_any("insertions", &W::insertions),
                      field_if_any("removals", &W::removals),
                      field_if_any("classified_cells", &W::classified_cells),
                      field_if_any("conflict_tests", &W::conflict_tests),
                      field_if_any("exact_decisions", &W::exact_decisions),
                      field_if_any("cells_created", &W::cells_created)};
  }
};

/// Seconds of a rank in one phase: processor seconds outside of collectives, and seconds in collectives.
struct SpentRecord {
  double computing_s = 0, waiting_s = 0, network_s = 0;
  static constexpr auto fields() {
    using S = SpentRecord;
    return std::tuple{field("computing_s", &S::computing_s), field("waiting_s", &S::waiting_s),
                      field("network_s", &S::network_s)};
  }
};

struct RankRecord {
  std::uint64_t cells = 0;
  ByName<SpentRecord> spent;
  JsonPointer as_written;
  static constexpr auto fields() {
    return std::tuple{field("cells", &RankRecord::cells), field("spent", &RankRecord::spent)};
  }
};

/// A round of all ranks.
struct RoundRecord {
  std::uint64_t deferred = 0;  ///< cells
  JsonPointer as_written;
  static constexpr auto fields() { return std::tuple{field("deferred", &RoundRecord::deferred)}; }
};

/// The ranks as podm-mpi reports them.
struct RanksRecord {
  std::uint64_t number = 0;
  double imbalance = 1;  ///< largest number of cells of a rank over the mean
  std::vector<RoundRecord> rounds;
  std::vector<RankRecord> by_rank;
  JsonPointer as_written;
  static constexpr auto fields() {
    using R = RanksRecord;
    return std::tuple{field("number", &R::number), field("imbalance", &R::imbalance),
                      field("rounds", &R::rounds), field("by_rank", &R::by_rank)};
  }
};

/// Cells with a dihedral angle out of bounds, by whether a vertex of theirs is free.
struct PoorCellsRecord {
  std::uint64_t with_free_vertex = 0, without = 0;
  static constexpr auto fields() {
    using P = PoorCellsRecord;
    return std::tuple{field("with_free_vertex", &P::with_free_vertex), field("without", &P::without)};
  }
};

/// The effect of moving vertices (R7) on dihedral angles.
struct PerturbedRecord {
  double min_dihedral_deg = 0, max_dihedral_deg = 0;  ///< the bounds
  PoorCellsRecord before, after;
  ByName<std::uint64_t> unmoved;  ///< cells of `after`, by reason
  static constexpr auto fields() {
    using P = PerturbedRecord;
    return std::tuple{field("min_dihedral_deg", &P::min_dihedral_deg),
                      field("max_dihedral_deg", &P::max_dihedral_deg), field("before", &P::before),
                      field("after", &P::after), field("unmoved", &P::unmoved)};
  }
};

/// The effect of optimisation on dihedral angles: numbers of cells beyond the aim and beyond the bounds.
struct OptimizationRecord {
  double least_aim_deg = 0, largest_aim_deg = 0;
  std::uint64_t beyond_aim_before = 0, beyond_aim = 0, beyond_bounds_before = 0, beyond_bounds = 0;
  ByName<std::uint64_t> obstacles;  ///< of the cells beyond the bounds
  ByName<std::uint64_t> successes;  ///< operations that improved cells, by kind
  static constexpr auto fields() {
    using O = OptimizationRecord;
    return std::tuple{field("least_aim_deg", &O::least_aim_deg),
                      field("largest_aim_deg", &O::largest_aim_deg),
                      field("beyond_aim_before", &O::beyond_aim_before),
                      field("beyond_aim", &O::beyond_aim),
                      field("beyond_bounds_before", &O::beyond_bounds_before),
                      field("beyond_bounds", &O::beyond_bounds),
                      field("obstacles", &O::obstacles),
                      field("successes", &O::successes)};
  }
};

/// Dihedral angles of all cells, in degrees, as podm-verify counts them.
struct DihedralRecord {
  double least = 0, largest = 0;
  std::vector<std::uint64_t> counts;  ///< one bin per degree, from 0; six angles per cell
  static constexpr auto fields() {
    using D = DihedralRecord;
    return std::tuple{field("least", &D::least), field("largest", &D::largest), field("counts", &D::counts)};
  }
};

/// Compares the labels of a mesh with those of its image: counts labels whose number of components, and
/// labels whose Euler number, is that of the image under one of its two connectivities or lies between the
/// two.
struct TopologyRecord {
  std::uint64_t labels = 0, components_as_image = 0, euler_as_image = 0;
  static constexpr auto fields() {
    using T = TopologyRecord;
    return std::tuple{field("labels", &T::labels), field("components_as_image", &T::components_as_image),
                      field("euler_as_image", &T::euler_as_image)};
  }
};

/// The inputs of podm-verify beside the mesh and the image: claims, and options with their
/// bounds.
struct JudgingRecord {
  std::vector<std::string> claims, options;
  static constexpr auto fields() {
    return std::tuple{field("claims", &JudgingRecord::claims), field("options", &JudgingRecord::options)};
  }
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
  std::optional<ByName<Proof>> verdicts;             ///< one per claim; unset if podm-verify did not run
  std::optional<DihedralRecord> dihedral_deg;        ///< unset if podm-verify did not report it
  std::optional<TopologyRecord> topology;            ///< unset if podm-verify had no image
  std::optional<std::vector<std::string>> promises;  ///< promised claims; unset: all
  std::string stop_reason;
  JsonPointer as_written;
  static constexpr auto fields() {
    using M = MeshRecord;
    return std::tuple{field_if_any("schema", &M::schema),
                      field_if_any("input", &M::input),
                      field_if_any("mesh", &M::mesh),
                      field_if_any("algorithm", &M::algorithm),
                      field_if_any("options", &M::options),
                      field_if_any("used", &M::used),
                      field_if_any("verify", &M::verify),
                      field_if_any("seed", &M::seed),
                      field_if_any("threads", &M::threads),
                      field_if_any("virtual", &M::virtual_time),
                      field_if_any("ranks", &M::ranks),
                      field("phases_s", &M::phases_s),
                      field("cells", &M::cells),
                      field("vertices", &M::vertices),
                      field_if_any("boundary_facets", &M::boundary_facets),
                      field_if_any("surface_cells", &M::surface_cells),
                      field_if_any("cells_per_second", &M::cells_per_second),
                      field("refine_cells_per_second", &M::refine_cells_per_second),
                      field_if_any("outcomes", &M::outcomes),
                      field_if_any("overhead_s", &M::overhead_s),
                      field_if_any("hops", &M::hops),
                      field_if_any("hops_by_kind", &M::hops_by_kind),
                      field_if_any("counters", &M::counters),
                      field_if_any("perturbed", &M::perturbed),
                      field_if_any("optimization", &M::optimization),
                      field_if_any("promised_dihedral_deg", &M::promised_dihedral_deg),
                      field("guarantees", &M::guarantees),
                      field_if_any("mesh_sha256", &M::mesh_sha256),
                      field_if_any("verdicts", &M::verdicts),
                      field_if_any("dihedral_deg", &M::dihedral_deg),
                      field_if_any("topology", &M::topology),
                      field_if_any("promises", &M::promises),
                      field("stop_reason", &M::stop_reason)};
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
    using L = LatencyRecord;
    return std::tuple{field("working_set_bytes", &L::working_set_bytes), field("node", &L::node),
                      field("ns", &L::ns), field("cycles", &L::cycles),
                      field("huge_page_share", &L::huge_page_share)};
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
    using M = MemoryLevel;
    return std::tuple{field("level", &M::level),
                      field("module", &M::module),
                      field("size_bytes", &M::size_bytes),
                      field_if_any("working_set_bytes", &M::working_set_bytes),
                      field_if_any("node", &M::node),
                      field("ns", &M::ns),
                      field("cycles", &M::cycles),
                      field_if_any("huge_page_share", &M::huge_page_share),
                      field_if_any("likwid_bench_cycles_per_line", &M::likwid_bench_cycles_per_line)};
  }
};

/// The record of `podm-bench latency`: Table 3 for this machine.
struct MemoryLevelsRecord {
  int processor = 0;    ///< the processor that measured
  bool pinned = false;  ///< the thread was bound to it
  std::vector<MemoryLevel> memory_levels;
  std::vector<LatencyRecord> latency;  ///< one per working set, of all sizes
  static constexpr auto fields() {
    using M = MemoryLevelsRecord;
    return std::tuple{field("processor", &M::processor), field("pinned", &M::pinned),
                      field("memory_levels", &M::memory_levels), field("latency", &M::latency)};
  }
};

}  // namespace podm::bench
