// Facets as sides of cells, the only way in which some formats know them.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

struct FacetSide {
  static constexpr std::uint32_t kNoCell = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t cell = kNoCell;
  std::uint32_t opposite = 0;  ///< position in the cell of the vertex that is not the facet's
};

/// The side that each facet is of the cell behind it, which has the facet's second label. Takes 8 bytes a
/// facet and 9 a vertex while it runs.
std::vector<FacetSide> find_facet_sides(const TetMesh& mesh);

}  // namespace podm
