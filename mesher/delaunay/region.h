// The cells that an operation replaces, and the facets that bound them.
#pragma once

#include <vector>

#include "delaunay/mesh.h"

namespace podm {

struct Region {
  std::vector<CellId> cells;      // cells to replace; marked (Mesh::mark)
  std::vector<FacetId> boundary;  // facets of `cells` whose other side stays
  std::vector<VertexId> removed;  // vertices removed with them
  std::vector<CellId> created;    // filled by the commit
  void clear() {
    cells.clear();
    boundary.clear();
    removed.clear();
  }
};

}  // namespace podm
