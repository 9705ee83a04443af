// The start of an operation at a cell of a list. It locks two of the cell's vertices, which is enough to read
// the cell, if the cell is still the one that was listed.
#pragma once

#include <array>
#include <span>

#include "delaunay/mesh.h"
#include "delaunay/planted_fault.h"
#include "delaunay/step_result.h"

namespace podm {

/// Calls lock(vertex) for two vertices of the cell, if locks are shared. kStaleCell: the cell has another
/// stamp. Unless the result is kDone, the caller releases all locks.
//
// The stamp is compared under the locks: a worker that replaced the cell after this peek held both vertices
// before this worker did, and a peek that returns the new cell sees the new stamp as well. Stamps repeat
// (mesh.h). A cell with the same stamp is therefore read only if it has the vertices that are locked.
template <class Locks, class Lock>
StepResult lock_to_read(const Mesh& mesh, CellId c, std::uint32_t stamp, const Lock& lock) {
  if constexpr (!Locks::kIsShared)
    return mesh.stamp(c) == stamp && mesh.peek_is_alive(c) ? StepResult::kDone : StepResult::kStaleCell;
  StepResult result = StepResult::kDone;
  const std::array<VertexId, 2> two = mesh.peek_two_vertices(c);
  for (const VertexId v : std::span(two).first(locks_taken().to_read)) {
    if (result != StepResult::kDone) break;
    result = v == kNoVertex ? StepResult::kStaleCell : lock(v);
  }
  if (mesh.stamp(c) != stamp) return StepResult::kStaleCell;
  return result == StepResult::kDone && mesh.peek_two_vertices(c) != two ? StepResult::kStaleCell : result;
}

}  // namespace podm
