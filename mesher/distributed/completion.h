// What a rank learns when rounds have ended: its piece is to be one of the whole mesh.
#pragma once

#include "distributed/communication.h"
#include "distributed/vertex_exchange.h"

namespace podm {

/// Learns what others have changed until every cell with a vertex in `own` is one of the whole, and so are
/// its neighbours; first what lies within so many `rings` of cubes. Collective.
Update complete(const Mesh& mesh, VertexExchange& exchange, const CubeSet& own, int rings,
                Communication& ranks);

}  // namespace podm
