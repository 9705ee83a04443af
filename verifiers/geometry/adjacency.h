// The facets that cells share: the one piece of connectivity that all claims build on.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh.h"

namespace podm::verify {

/// Facet i of a cell (v0,v1,v2,v3) is opposite v_i. In this order its vertices turn counter-clockwise seen
/// from v_i if the cell is positive, that is if dot(cross(v1-v0, v2-v0), v3-v0) > 0.
inline constexpr std::array<std::array<int, 3>, 4> kFacetVertices{
    {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

using FacetId = std::uint32_t;  ///< 4 * cell + i

inline std::array<VertexId, 3> vertices_of(const Mesh& mesh, FacetId f) {
  const auto& cell = mesh.cells[f / 4];
  const auto& local = kFacetVertices[f % 4];
  return {cell[static_cast<std::size_t>(local[0])], cell[static_cast<std::size_t>(local[1])],
          cell[static_cast<std::size_t>(local[2])]};
}
/// Returns the vertex of the cell opposite the facet.
inline VertexId far_vertex(const Mesh& mesh, FacetId f) { return mesh.cells[f / 4][f % 4]; }

/// Mirrors of all facets of a mesh whose ids are in range (structure's first statement).
struct Adjacency {
  /// The same facet seen from the one other cell that has it; kNone on the boundary of the mesh.
  std::vector<FacetId> mirror;
  /// Facets that three or more cells have, one entry per cell facet, grouped. Their mirror is kNone too.
  std::vector<std::vector<FacetId>> crowded;
};

/// Takes O(n) time. About 16 bytes per cell are kept, and 17 more are used during the call. `threads` >= 1.
Adjacency find_adjacency(const Mesh& mesh, int threads);

/// Returns 1 for every vertex that a cell has, 0 for the others.
std::vector<std::uint8_t> used_vertices(const Mesh& mesh);

}  // namespace podm::verify
