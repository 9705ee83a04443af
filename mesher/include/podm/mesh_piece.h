// One rank's piece of a mesh that no rank holds whole.
#pragma once

#include <cstdint>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

/// Every cell and every facet of the whole mesh is in one piece. A vertex is in each piece that uses it: its
/// coordinates there are the same to the bit, and so is its number.
struct MeshPiece {
  int rank = 0, num_pieces = 1;
  TetMesh mesh;                           ///< vertices are those that its cells and facets use
  std::vector<std::uint64_t> vertex_ids;  ///< one a vertex: its number in the whole mesh, from 0
  std::vector<std::uint8_t> owns_vertex;  ///< one a vertex: 1 in one of the pieces that use it, 0 in others
  std::uint64_t first_cell = 0, first_facet = 0;  ///< cells and facets of the pieces before this one
  std::uint64_t total_vertices = 0, total_cells = 0, total_facets = 0;
};

}  // namespace podm
