// The obstacles that keep a bad cell from being improved.
#pragma once

#include "delaunay/mesh.h"
#include "geometry/dihedral.h"
#include "podm/choices.h"

namespace podm {

/// True if two interface facets of the cell meet at an angle below the bound: then only a peel helps. An
/// angle that is too large may be shared by two cells.
bool has_frozen_small_angle(const Mesh& mesh, CellId c, const DihedralBounds& bounds);

/// Returns the obstacle of a cell beyond the bounds.
OptimizationObstacle obstacle_of(const Mesh& mesh, CellId c, const DihedralBounds& bounds);

}  // namespace podm
