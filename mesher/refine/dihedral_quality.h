// Quality of a cell's dihedral angles, in a mesh or in the cells that an operation plans, and the cells that
// R7 calls poor.
#pragma once

#include <algorithm>

#include "delaunay/mesh.h"
#include "geometry/dihedral.h"
#include "refine/rules.h"

namespace podm {

/// Returns the quality with respect to the bounds: 1 at a bound, less beyond it.
template <class Cells>
double dihedral_quality(const Cells& cells, CellId c, const DihedralBounds& bounds) {
  const auto& v = cells.cell(c).vertices;
  return bounds.quality(
      dihedral_extremes(cells.point(v[0]), cells.point(v[1]), cells.point(v[2]), cells.point(v[3])));
}

/// True if the cell is inside the object and has an angle out of bounds.
inline bool is_poor(const Mesh& mesh, const Rules& rules, CellId c, const DihedralBounds& bounds) {
  return dihedral_quality(mesh, c, bounds) < 1 && rules.label_of(c) != kBackground;
}

/// True if one of the cell's vertices is bound to no surface.
inline bool has_free_vertex(const Mesh& mesh, CellId c) {
  const auto& vertices = mesh.cell(c).vertices;
  return std::any_of(vertices.begin(), vertices.end(),
                     [&](VertexId v) { return mesh.vertex(v).kind == VertexKind::kCircumcenter; });
}

}  // namespace podm
