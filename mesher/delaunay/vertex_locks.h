// The place of the vertex locks in the protocol: an operation try-locks every vertex of every cell it touches
// before it writes anything, and releases all of them at its end.
#pragma once

#include "delaunay/mesh.h"

namespace podm {

/// The locks of a run that nobody shares: every attempt succeeds and costs nothing.
struct NoLocks {
  static constexpr bool try_lock(Vertex&) { return true; }
  static constexpr void unlock_all() {}
};

}  // namespace podm
