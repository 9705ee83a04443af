// The peel: a flat cell on an interface is given to a label on its other side. It is the only change that
// moves an interface, by less than the cell's height, and each peel is counted.
#pragma once

#include <array>

#include "delaunay/mesh.h"
#include "geometry/tetrahedron.h"

namespace podm {

/// The effect of a peel of a cell to a label on the cell's facets: facets towards the label leave the
/// interface, facets towards the cell's own label come to it, and other facets stay.
struct Peel {
  unsigned num_going = 0, num_coming = 0;
  std::array<unsigned, 4> coming{};  // the facets that come, by their index in the cell

  Peel(const Mesh& mesh, CellId c, LabelIndex label);
  /// The edge that two coming facets share. It is the only edge that may come to the interface.
  unsigned edge() const;
};

/// True if the cell may be peeled, apart from the one edge that comes to the interface: the cell is lower
/// than a twentieth of delta; at least as many facets leave as come, and at most two come; the angles of the
/// coming facets keep the bound on facet angles; and all vertices are on the isosurface.
bool may_be_peeled(const Mesh& mesh, CellId c, const Peel& peel, double delta_mm);

}  // namespace podm
