// The cells that an operation replaces, and what bounds them.
#pragma once

#include <vector>

#include "delaunay/mesh.h"

namespace podm {

struct Region {
  std::vector<CellId> cells;      // die; marked (Mesh::mark)
  std::vector<FacetId> boundary;  // facets of `cells` whose other side stays
  std::vector<VertexId> removed;  // vertices that go with them
  std::vector<CellId> created;    // filled by the committing step
  void clear() {
    cells.clear();
    boundary.clear();
    removed.clear();
  }
};

}  // namespace podm
