// What becomes of one step of an operation: of a lock, a reservation, a plan, a commit.
#pragma once

namespace podm {

enum class StepResult {
  kDone,
  kLockConflict,   ///< another worker holds a vertex
  kOutOfLeaf,      ///< a vertex lies outside the region of the leaf being refined
  kStaleCell,      ///< of a reservation: the cell has died
  kNotInConflict,  ///< of a plan: the point lies outside the ball of the cell where its cavity was to begin
  kTooNear,        ///< of a commit: to a vertex, or the region has too many vertices
};

}  // namespace podm
