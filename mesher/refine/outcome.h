// What becomes of a worker's attempt at one cell.
#pragma once

namespace podm {

enum class Outcome {
  kCommitted,     ///< a vertex was inserted
  kSound,         ///< the cell breaks no rule
  kStaleCell,     ///< the cell has died
  kLockConflict,  ///< nothing was changed, and the cell is back on the list
  kRejected,      ///< nothing was changed: a vertex is too near to the point, or covers it
  kOutOfLeaf,     ///< nothing was changed, and the cell is among the deferred
};

}  // namespace podm
