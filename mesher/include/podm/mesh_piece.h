// One rank's piece of a mesh that no rank holds as a whole.
#pragma once

#include <cstdint>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

/// A part of the whole mesh. Every cell and every facet of the whole mesh is in exactly one piece. A vertex
/// is in each piece that uses it, with bitwise equal coordinates and the same number.
struct MeshPiece {
  int rank = 0, num_pieces = 1;
  TetMesh mesh;                           ///< holds only the vertices that its cells and facets use
  std::vector<std::uint64_t> vertex_ids;  ///< one per vertex: its number in the whole mesh, from 0
  /// One per vertex: 1 in exactly one of the pieces that use it, 0 in the other pieces.
  std::vector<std::uint8_t> owns_vertex;
  /// Numbers of cells and facets of the pieces before this one.
  std::uint64_t first_cell = 0, first_facet = 0;
  std::uint64_t total_vertices = 0, total_cells = 0, total_facets = 0;
};

}  // namespace podm
