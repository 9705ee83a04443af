// Which cells share which facets: the one piece of connectivity that all claims build on.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh.h"

namespace podm::verify {

/// Facet i of a cell (v0,v1,v2,v3) is opposite v_i; in this order its vertices turn counter-clockwise seen
/// from v_i when the cell is positive, that is when dot(cross(v1-v0, v2-v0), v3-v0) > 0.
inline constexpr std::array<std::array<int, 3>, 4> kFacetVertices{
    {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

using FacetId = std::uint32_t;  ///< 4 * cell + i

/// Mirrors of all facets of a mesh whose ids are in range (structure's first statement).
struct Adjacency {
  /// The same facet seen from the one other cell that has it; kNone on the boundary of the mesh.
  std::vector<FacetId> mirror;
  /// Facets that three or more cells have, one entry a cell facet, grouped; their mirror is kNone too.
  std::vector<std::vector<FacetId>> crowded;
};

/// Time O(n), about 16 bytes a cell kept and 48 more while it runs. `threads` >= 1.
Adjacency find_adjacency(const Mesh& mesh, int threads);

}  // namespace podm::verify
