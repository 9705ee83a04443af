// Walks from cell to cell: to the cell that contains a point, and around an edge or a vertex. The visibility
// walk to a point ends in a Delaunay triangulation (Edelsbrunner, Combinatorica 10 (1990) 251-260).
#pragma once

#include <optional>
#include <vector>

#include "delaunay/mesh.h"

namespace podm {

/// Returns the cell on the other side of a facet of c that p lies beyond, except `previous`, the cell that
/// the walk comes from; c itself if there is no such facet.
CellId next_towards(const Mesh& mesh, const Point& p, CellId c, CellId previous);

/// The mesh must not change meanwhile. Returns a cell that contains p, a point in the box or on its boundary.
/// `from` must be alive.
CellId cell_with(const Mesh& mesh, const Point& p, CellId from);

/// Returns `from` if it is alive, otherwise the next living cell.
inline CellId living_cell(const Mesh& mesh, CellId from) {
  while (!mesh.cell(from).is_alive()) from = (from + 1) % mesh.cell_bound();
  return from;
}

/// Leaves the cells around v in `ball`, `c` first, which is one of them. It marks them meanwhile, so that no
/// worker may run.
void find_around_vertex(Mesh& mesh, VertexId v, CellId c, std::vector<CellId>& ball);

/// Returns a cell around the edge from u to v for which accept(cell) holds. `c` is one of these cells. All of
/// them may be read under locks on u and v, which must not lie on the box.
template <class Accept>
std::optional<CellId> find_around_edge(const Mesh& mesh, CellId c, VertexId u, VertexId v,
                                       const Accept& accept) {
  CellId previous = c, at = c;
  do {
    if (accept(at)) return at;
    const Cell& cell = mesh.cell(at);
    CellId next = at;
    for (unsigned k = 0; k < 4 && next == at; ++k)
      if (cell.vertices[k] != u && cell.vertices[k] != v && cell_of(cell.mirrors[k]) != previous)
        next = cell_of(cell.mirrors[k]);
    previous = at;
    at = next;
  } while (at != c);
  return std::nullopt;
}

}  // namespace podm
