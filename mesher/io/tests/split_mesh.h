// A mesh cut into pieces, as ranks would hold it.
#pragma once

#include <vector>

#include "podm/mesh_piece.h"

namespace podm {

/// Returns pieces with about equal numbers of cells, in the order of the cells. If there are fewer cells than
/// pieces, some pieces are empty. A facet is in the piece of the cell that its normal points out of. A vertex
/// is owned by the first piece that uses it; numbers ascend through the owners' pieces.
std::vector<MeshPiece> split_into_pieces(const TetMesh& mesh, int num_pieces);

}  // namespace podm
