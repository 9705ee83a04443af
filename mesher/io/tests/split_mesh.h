// A mesh cut into pieces, as ranks would hold it.
#pragma once

#include <vector>

#include "podm/mesh_piece.h"

namespace podm {

/// Pieces of about as many cells, in their order; fewer cells than pieces leave some without any. A facet is
/// in the piece of the cell that its normal points out of. A vertex is owned by the first piece that uses it;
/// numbers run through the owners' pieces.
std::vector<MeshPiece> split_into_pieces(const TetMesh& mesh, int num_pieces);

}  // namespace podm
