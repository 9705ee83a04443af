// Quality of a cell's dihedral angles, in a mesh or in the cells that an operation plans.
#pragma once

#include "delaunay/mesh.h"
#include "geometry/dihedral.h"

namespace podm {

/// Returns the quality with respect to the bounds: 1 at a bound, less beyond it.
template <class Cells>
double dihedral_quality(const Cells& cells, CellId c, const DihedralBounds& bounds) {
  const auto& v = cells.cell(c).vertices;
  return bounds.quality(
      dihedral_extremes(cells.point(v[0]), cells.point(v[1]), cells.point(v[2]), cells.point(v[3])));
}

}  // namespace podm
