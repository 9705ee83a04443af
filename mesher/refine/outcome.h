// The outcome of a worker's attempt at one cell.
#pragma once

#include "delaunay/step_result.h"
#include "podm/errors.h"

namespace podm {

enum class Outcome {
  kCommitted,     ///< a vertex was inserted or moved, or cells were replaced by better ones
  kSound,         ///< the cell violates no rule, or is good
  kStaleCell,     ///< the cell has died
  kLockConflict,  ///< nothing was changed, and the cell is back on the list
  kRejected,      ///< nothing was changed: a vertex is too near to the point or covers it, or the point lies
              ///< outside the ball of its cell, or a line cannot make room for it, or R7 found no point, or
              ///< there are no better cells
  kOutOfLeaf,  ///< nothing was changed, and the cell is deferred
};

/// Returns the outcome of an attempt that ends at a step other than kDone. Throws InternalError for kDone.
inline Outcome outcome_of(StepResult result) {
  switch (result) {
    case StepResult::kLockConflict:
      return Outcome::kLockConflict;
    case StepResult::kOutOfReach:
      return Outcome::kOutOfLeaf;
    case StepResult::kStaleCell:
      return Outcome::kStaleCell;
    case StepResult::kNotInConflict:
    case StepResult::kTooNear:
    case StepResult::kCovered:
    case StepResult::kNoMove:
    case StepResult::kAtFloor:
    case StepResult::kNotBetter:
      return Outcome::kRejected;
    case StepResult::kDone:
      break;
  }
  throw InternalError("a step that is done ends no attempt");
}

}  // namespace podm
