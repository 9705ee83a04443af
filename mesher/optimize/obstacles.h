// What keeps a bad cell from being made better.
#pragma once

#include "delaunay/mesh.h"
#include "geometry/dihedral.h"
#include "podm/choices.h"

namespace podm {

/// Whether two facets of interfaces meet at an angle below the bound: then nothing but a peel helps. An angle
/// that is too large may be shared by two cells.
bool has_frozen_small_angle(const Mesh& mesh, CellId c, const DihedralBounds& bounds);

/// Of a cell beyond the bounds.
OptimizationObstacle obstacle_of(const Mesh& mesh, CellId c, const DihedralBounds& bounds);

}  // namespace podm
