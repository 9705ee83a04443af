// The counts of workers. A new count needs a member of Counters, a line of kCounts (which sums counts and
// writes them to records), and the place that counts it.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace podm {

/// Seconds in which workers made no progress on the mesh, by cause.
struct Overhead {
  double contention_s = 0, begging_s = 0, rollback_s = 0;
};

/// Memory accesses by the number of hops from the worker's NUMA node to the node that owns the memory. Empty
/// on a machine with one node.
struct HopsByKind {
  /// Cells tested, vertices locked; the owner is the node whose worker made them.
  std::vector<std::uint64_t> mesh_reads;
  /// Cells and vertices that filling and gluing wrote; the owner is the same.
  std::vector<std::uint64_t> mesh_writes;
  /// Labels of the image, one or several per access, within one row of voxels.
  std::vector<std::uint64_t> image_reads;
  std::vector<std::uint64_t> transform_reads;  ///< words of the feature transform
};

/// Exact counts of operations by outcome and of work done, and the time lost.
struct Counters {
  std::array<std::uint64_t, 6> insertions_by_rule{};  ///< R1..R5, R0
  std::uint64_t removals = 0;                         ///< vertices removed by R6
  /// Insertions given up: a vertex was nearer than the spacing floor, or a circumcenter was outside its
  /// cell's ball. Points of R1 and R3 that were refused during planning are not counted.
  std::uint64_t rejected = 0;
  std::uint64_t stale_cells = 0;  ///< poor element list entries whose cell had died
  std::uint64_t classified_cells = 0;
  std::uint64_t oracle_searches = 0;  ///< searches for the isosurface point nearest to a cell's circumcenter
  std::uint64_t conflict_tests = 0;
  std::uint64_t exact_decisions = 0;  ///< conflict tests that the cached sphere left undecided
  std::uint64_t cells_created = 0;
  std::uint64_t lock_conflicts = 0;  ///< attempts that ended in a rollback
  std::uint64_t out_of_leaf = 0;   ///< attempts deferred because they needed vertices outside a leaf's region
  std::uint64_t region_cells = 0;  ///< cells that operations collected for replacement, committed or not
  std::uint64_t moves = 0;         ///< vertices moved by R7
  std::uint64_t points_tried = 0;  ///< points tried for R7 moves, including points that failed
  std::uint64_t planned_cells = 0;  ///< cells that R7 planned, committed or not
  Overhead overhead;
  HopsByKind hops;

  std::uint64_t num_insertions() const {
    return std::accumulate(insertions_by_rule.begin(), insertions_by_rule.end(), std::uint64_t{0});
  }
  /// Vertices inserted, removed and moved.
  std::uint64_t num_committed() const { return num_insertions() + removals + moves; }
};

/// A count's name and its place in a record.
struct Count {
  const char* name;
  std::uint64_t Counters::*member;
  /// Group in the record: the outcomes of attempts, or the counters of work.
  enum Kind { kOutcome, kWork } kind;
  bool by_worker;  ///< also recorded per worker
};
inline constexpr std::array kCounts{
    Count{"stale_cell", &Counters::stale_cells, Count::kOutcome, true},
    Count{"rejected", &Counters::rejected, Count::kOutcome, true},
    Count{"lock_conflict", &Counters::lock_conflicts, Count::kOutcome, true},
    Count{"out_of_leaf", &Counters::out_of_leaf, Count::kOutcome, false},
    Count{"removals", &Counters::removals, Count::kWork, false},
    Count{"classified_cells", &Counters::classified_cells, Count::kWork, false},
    Count{"oracle_searches", &Counters::oracle_searches, Count::kWork, false},
    Count{"conflict_tests", &Counters::conflict_tests, Count::kWork, true},
    Count{"exact_decisions", &Counters::exact_decisions, Count::kWork, false},
    Count{"cells_created", &Counters::cells_created, Count::kWork, false},
    Count{"region_cells", &Counters::region_cells, Count::kWork, true},
    Count{"moves", &Counters::moves, Count::kWork, false},
    Count{"points_tried", &Counters::points_tried, Count::kWork, false},
    Count{"planned_cells", &Counters::planned_cells, Count::kWork, false}};

/// A cause of overhead and its name in records.
struct Cause {
  const char* name;
  double Overhead::*member;
};
inline constexpr std::array kCauses{Cause{"contention", &Overhead::contention_s},
                                    Cause{"begging", &Overhead::begging_s},
                                    Cause{"rollback", &Overhead::rollback_s}};

static_assert(sizeof(Overhead) == kCauses.size() * sizeof(double), "each cause has its line");
static_assert(sizeof(Counters) == sizeof(Counters::insertions_by_rule) +
                                      kCounts.size() * sizeof(std::uint64_t) + sizeof(Overhead) +
                                      sizeof(HopsByKind),
              "each count has its line");

}  // namespace podm
