// What becomes of one step of an operation: of a lock, a reservation, a plan, a commit.
#pragma once

namespace podm {

enum class StepResult {
  kDone,
  kLockConflict,   ///< another worker holds a vertex
  kOutOfReach,     ///< these locks may not have a vertex (algorithms/leaf_locks.h)
  kStaleCell,      ///< a reservation found that the cell has died
  kNotInConflict,  ///< a plan found the point outside the ball of the cell where its cavity was to begin
  kTooNear,        ///< a commit found a vertex too near, or too many vertices in the region
  kNoMove,         ///< R7 found no point for a vertex of a poor cell
  kCovered,        ///< the worker found an isosurface vertex that covers the point
  kNotBetter,      ///< an optimisation found no better cells (optimize/)
};

}  // namespace podm
