// Visibility walk to the cell that contains a point. In a Delaunay triangulation such walks end
// (Edelsbrunner, Combinatorica 10 (1990) 251-260).
#pragma once

#include "delaunay/mesh.h"

namespace podm {

/// Returns the cell on the other side of a facet of c that p lies beyond, except `previous`, the cell that
/// the walk comes from; c itself if there is no such facet.
CellId next_towards(const Mesh& mesh, const Point& p, CellId c, CellId previous);

/// The mesh must not change meanwhile. Returns a cell that contains p, a point in the box or on its boundary.
/// `from` must be alive.
CellId cell_with(const Mesh& mesh, const Point& p, CellId from);

}  // namespace podm
