// Facets as sides of cells, as some formats store them.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

struct FacetSide {
  static constexpr std::uint32_t kNoCell = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t cell = kNoCell;
  std::uint32_t opposite = 0;  ///< position in the cell of the vertex that is not on the facet
};

/// Returns, for each facet, the side of the cell behind it, which has the facet's second label. Takes 8 bytes
/// per facet and 9 per vertex while it runs.
std::vector<FacetSide> find_facet_sides(const TetMesh& mesh);

}  // namespace podm
