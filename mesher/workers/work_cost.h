// What work takes on the reference core: the one place where times of virtual work stand. Each is a constant
// with its source; the cores of a described machine do `core_speed` times as much (runtime/machine_model.h).
//
// The reference core is one of experiments/machines/epyc_zen5_2_cores.toml, with what `make build` compiles.
// The costs of attempts are the parts of a profile, the liver at 3 million cells, each over the count that it
// goes with, all lengthened by 6 % for the median of eleven images and sizes; the others were timed one by
// one. Commit 584d07f has counts, seconds and residuals, in
// results/reference/amd-epyc-zen5-2-cores/README.md.
#pragma once

#include <cstdint>

#include "podm/counters.h"

namespace podm {

/// Counted work, of a worker so far or between two moments.
struct Work {
  std::uint64_t classified = 0, searches = 0, tests = 0, created = 0, planned = 0;

  Work operator-(const Work& b) const {
    return {classified - b.classified, searches - b.searches, tests - b.tests, created - b.created,
            planned - b.planned};
  }
};
inline Work work_of(const Counters& counters) {
  return {counters.classified_cells, counters.oracle_searches, counters.conflict_tests,
          counters.cells_created, counters.planned_cells};
}

/// Of an attempt, for the entry that it takes off the list; where that is stale, all of it.
inline constexpr double kListLookedUp = 0.011e-6;
/// Seconds of an attempt with that work. Where others may want the same vertices it takes locks.
double attempt_seconds(const Work& work, bool takes_locks);

// ---- Between attempts ----

/// A worker that begs puts itself on a list, under its lock; so does one that serves it.
inline constexpr double kBegging = 0.2e-6;
/// An entry of a poor element list that changes hands.
inline constexpr double kEntryGiven = 0.01e-6;
/// An entry that is listed with the leaf that has its circumcentre.
inline constexpr double kEntryToLeaf = 0.055e-6;
/// A cell of the initial mesh that moves to another node's memory.
inline constexpr double kCellMoved = 0.1e-6;
/// A cell whose dihedral angles are looked at.
inline constexpr double kCellJudged = 0.05e-6;
/// The label at a point of space.
inline constexpr double kPlaceLookedUp = 0.1e-6;
/// A leaf whose cells the queue is told of, and that is shared out.
inline constexpr double kLeafSharedOut = 1.3e-6;
/// A leaf is taken off the refinement queue or given back, with its buffer zones, under the queue's lock.
inline constexpr double kLeafHandedOut = 20e-6;

// ---- Before and after refinement, of one thread; loops share it among all ----

inline constexpr double kVoxelRead = 3e-9;          // from a compressed file, on one thread
inline constexpr double kVoxelTransformed = 50e-9;  // on all
inline constexpr double kThreadStarted = 15e-6;     // by the thread that the run is called from
inline constexpr double kCubeMade = 2e-6;           // of the octree, on one thread
inline constexpr double kCellExtracted = 37e-9;     // on all

}  // namespace podm
