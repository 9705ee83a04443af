// The result of one step of an operation: a lock, a reservation, a plan or a commit.
#pragma once

namespace podm {

enum class StepResult {
  kDone,
  kLockConflict,   ///< another worker holds a vertex
  kOutOfReach,     ///< these locks do not reach a vertex (algorithms/leaf_locks.h)
  kStaleCell,      ///< a reservation found that the cell has died
  kNotInConflict,  ///< a plan found the point outside the ball of the cell where the cavity should begin
  kTooNear,        ///< a commit found a vertex too near, or the region has too many vertices
  kNoMove,         ///< R7 found no point for a vertex of a poor cell
  kCovered,        ///< the worker found an isosurface vertex that covers the point
  kAtFloor,        ///< an edge of a line is too short to be split (refine/line_edges.h)
  kNotBetter,      ///< an optimisation found no better cells (optimize/)
};

}  // namespace podm
