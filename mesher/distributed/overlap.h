// The check that ranks agree where they overlap. A rank reads vertices that other ranks wrote. If it has
// other vertices there than they have, it makes cells that are no cells of the whole mesh. Neither messages
// nor the insertion of what they bring should ever cause that. The check finds it before it spoils the mesh.
#pragma once

#include <functional>

#include "delaunay/mesh.h"
#include "distributed/communication.h"
#include "distributed/cubes.h"

namespace podm {

/// Compares, for each of the cubes in `known`, this rank's vertices with those of the rank that wrote the
/// cube last: their number, and the sum of the hashes of points and kinds. Throws InternalError on the writer
/// of a cube that differs. The text names the ranks and the cube. `threads`: at least 1. Collective.
void check_overlap(const Mesh& mesh, const CubeSet& known, const std::function<int(CubeId)>& writer_of,
                   std::size_t threads, Communication& ranks);

}  // namespace podm
