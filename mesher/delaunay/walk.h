// Visibility walk to the cell that has a point in it. In a Delaunay triangulation such walks end.
// (Edelsbrunner, Combinatorica 10 (1990) 251-260.) Nobody may change the mesh meanwhile.
#pragma once

#include "delaunay/mesh.h"

namespace podm {

/// A cell that has p, a point within the box, inside or on its boundary. `from` is alive.
CellId cell_with(const Mesh& mesh, const Point& p, CellId from);

}  // namespace podm
