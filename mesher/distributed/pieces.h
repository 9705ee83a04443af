// Extraction of each rank's piece of the mesh from its store, without a gather.
#pragma once

#include "distributed/rounds.h"
#include "isosurface/isosurface.h"
#include "podm/mesh_piece.h"

namespace podm {

/// Returns this rank's piece. A vertex belongs to the rank of its cube, a cell to the rank of its
/// lexicographically least vertex, and a facet to the rank of the cell that extract_mesh() gives it to.
/// Consumes the store. Collective. `space` is kRas or kLps. `facets_off_isosurface` receives the count of
/// this piece.
MeshPiece extract_piece(DistributedRefinement& refined, const Isosurface& isosurface, Space space,
                        int threads, Communication& ranks, std::uint64_t& facets_off_isosurface);

/// Returns the number of cells of the whole mesh. Collective.
std::uint64_t count_cells(DistributedRefinement& refined, const Isosurface& isosurface, int threads,
                          Communication& ranks);

}  // namespace podm
