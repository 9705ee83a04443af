// What workers count. A new count is a member of Counters, a line of kCounts, by which counts are summed and
// written to records, and the place where it is counted.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace podm {

/// Seconds that workers did not bring the mesh on, by cause.
struct Overhead {
  double contention_s = 0, begging_s = 0, rollback_s = 0;
};

/// Accesses to memory, by the hops from the worker's NUMA node to the one that owns the memory. Empty on one
/// node.
struct HopsByKind {
  std::vector<std::uint64_t> mesh_reads;   ///< cells tested, vertices locked; owned by whose worker made them
  std::vector<std::uint64_t> mesh_writes;  ///< cells and vertices that filling and gluing wrote; likewise
  std::vector<std::uint64_t> image_reads;  ///< labels of the image, one or some of a row at a time
  std::vector<std::uint64_t> transform_reads;  ///< words of the feature transform
};

/// Operations by outcome and work done, exact counts, and what was lost.
struct Counters {
  std::array<std::uint64_t, 5> insertions_by_rule{};  ///< R1..R5
  std::uint64_t removals = 0;                         ///< vertices removed by R6
  /// Insertions given up: a vertex lay nearer than the spacing floor, or a circumcentre outside its cell's
  /// ball. Points of R1 and R3 that were refused while planned are not counted.
  std::uint64_t rejected = 0;
  std::uint64_t stale_cells = 0;  ///< poor element list entries that had died
  std::uint64_t classified_cells = 0;
  std::uint64_t oracle_searches = 0;  ///< for the isosurface point nearest to a cell's circumcentre
  std::uint64_t conflict_tests = 0;
  std::uint64_t exact_decisions = 0;  ///< conflict tests that the cached sphere left undecided
  std::uint64_t cells_created = 0;
  std::uint64_t lock_conflicts = 0;  ///< attempts rolled back
  std::uint64_t out_of_leaf = 0;     ///< attempts that needed vertices outside a leaf's region, deferred
  std::uint64_t region_cells = 0;    ///< cells that operations collected to replace, carried out or not
  std::uint64_t moves = 0;           ///< vertices moved by R7
  std::uint64_t points_tried = 0;    ///< for these, and in vain
  std::uint64_t planned_cells = 0;   ///< cells that R7 planned, carried out or not
  Overhead overhead;
  HopsByKind hops;

  std::uint64_t num_insertions() const {
    return std::accumulate(insertions_by_rule.begin(), insertions_by_rule.end(), std::uint64_t{0});
  }
  /// Vertices inserted, removed and moved.
  std::uint64_t num_committed() const { return num_insertions() + removals + moves; }
};

/// A count's name, and where a record tells of it.
struct Count {
  const char* name;
  std::uint64_t Counters::*member;
  enum Kind { kOutcome, kWork } kind;  ///< among the outcomes of attempts, or the counters of work
  bool by_worker;                      ///< also for each worker
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
