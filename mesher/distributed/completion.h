// The last update of a rank after the rounds. It makes the rank's piece a piece of the whole mesh.
#pragma once

#include "distributed/communication.h"
#include "distributed/vertex_exchange.h"

namespace podm {

/// Learns the changes of other ranks until every cell with a vertex in `own` is a cell of the whole mesh, and
/// so are its neighbours. The first update covers `rings` rings of cubes around `own`. Collective.
Update complete(const Mesh& mesh, VertexExchange& exchange, const CubeSet& own, int rings,
                Communication& ranks);

}  // namespace podm
