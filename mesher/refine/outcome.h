// What becomes of a worker's attempt at one cell.
#pragma once

namespace podm {

enum class Outcome {
  kCommitted,     ///< a vertex was inserted
  kSound,         ///< the cell breaks no rule
  kStaleCell,     ///< the cell has died
  kLockConflict,  ///< nothing was changed, and the cell is back on the list
  kRejected,      ///< nothing was changed: the vertex would have come too near to another, or have covered nothing new
  kOutOfLeaf,     ///< nothing was changed, and the cell is among the deferred
};

}  // namespace podm
