// Each rank's piece of the mesh, taken from its store without gathering anything.
#pragma once

#include "distributed/rounds.h"
#include "isosurface/isosurface.h"
#include "podm/mesh_piece.h"

namespace podm {

/// A vertex belongs to the rank of its cube, a cell to that of its lexicographically least vertex, and a
/// facet to that of the cell that extract_mesh() gives it to. Uses the store up. Collective. `space` is kRas
/// or kLps. `facets_off_isosurface` counts this piece's.
MeshPiece extract_piece(DistributedRefinement& refined, const Isosurface& isosurface, Space space,
                        int threads, Communication& ranks, std::uint64_t& facets_off_isosurface);

}  // namespace podm
