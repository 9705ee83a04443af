// The update that makes a rank's part of the mesh a part of the whole mesh: of seeds before the rounds, of
// other ranks' vertices after them.
#pragma once

#include <vector>

#include "distributed/communication.h"
#include "distributed/vertex_source.h"

namespace podm {

/// Learns vertices of the source until every cell with a vertex in `own`, other than a corner of the virtual
/// box, is a cell of the whole mesh, and so are its neighbours. The first update covers `rings` rings of
/// cubes around `own`. `threads`: at least 1. Collective.
Update complete(const Mesh& mesh, VertexSource& source, const CubeSet& own, int rings, std::size_t threads,
                Communication& ranks);

/// Returns the cells that complete() would learn vertices for: they have a vertex in `own`, or a neighbour
/// with one, and may not be cells of the whole mesh if all vertices in `known` are known.
std::vector<CellId> unknown_cells(const Mesh& mesh, const CubeSet& own, const CubeSet& known,
                                  std::size_t threads);

}  // namespace podm
