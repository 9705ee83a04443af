// What becomes of an attempt to change the triangulation, and of each of its steps.
#pragma once

namespace podm {

enum class Outcome {
  kCommitted,
  kLockConflict,  ///< another worker holds a vertex
  kStaleCell,     ///< the cell has died
  kRejected,      ///< the point is not in conflict, or too near to a vertex
  kOutOfLeaf,     ///< a vertex lies outside the region of the leaf being refined
};

}  // namespace podm
