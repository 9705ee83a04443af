// How an operation begins at a cell of a list: it locks two of its vertices, by which it may be read, if the
// cell is still the one that was listed.
#pragma once

#include <array>
#include <span>

#include "delaunay/mesh.h"
#include "delaunay/planted_fault.h"
#include "delaunay/step_result.h"

namespace podm {

/// Calls lock(vertex) for two of them, if locks are shared. kStaleCell: the cell has not that stamp; whatever
/// is not kDone, the caller lets go of all locks.
//
// The stamp is compared under the locks: who replaced the cell after our peek held both vertices before us,
// and a peek of the new cell shows the new stamp as well.
template <class Locks, class Lock>
StepResult lock_to_read(const Mesh& mesh, CellId c, std::uint32_t stamp, const Lock& lock) {
  StepResult result = StepResult::kDone;
  if constexpr (Locks::kIsShared) {
    const std::array<VertexId, 2> two = mesh.peek_two_vertices(c);
    for (const VertexId v : std::span(two).first(locks_taken().to_read)) {
      if (result != StepResult::kDone) break;
      result = v == kNoVertex ? StepResult::kStaleCell : lock(v);
    }
  }
  return mesh.stamp(c) == stamp ? result : StepResult::kStaleCell;
}

}  // namespace podm
