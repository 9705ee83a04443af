// The peel: a flat cell on an interface is given to a label on its other side. It is the one change that
// moves an interface, by less than the cell's height, and each is counted.
#pragma once

#include <array>

#include "delaunay/mesh.h"
#include "geometry/tetrahedron.h"

namespace podm {

/// What a peel of a cell to a label does to its facets: those towards the label go from the interface, those
/// towards the cell's own come to it, and others stay.
struct Peel {
  unsigned num_going = 0, num_coming = 0;
  std::array<unsigned, 4> coming{};  // the facets by their index in the cell

  Peel(const Mesh& mesh, CellId c, LabelIndex label);
  /// The edge that two facets which come share; it is the only edge that may come to the interface.
  unsigned edge() const;
};

/// Whether the cell may be peeled, its one edge that comes to the interface apart: it is lower than a
/// twentieth of delta; as many facets go as come, or more, and two come at most; their angles keep the bound
/// on those of facets; and all vertices are on the isosurface.
bool may_be_peeled(const Mesh& mesh, CellId c, const Peel& peel, double delta_mm);

}  // namespace podm
