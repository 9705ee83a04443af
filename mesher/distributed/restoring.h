// The vertices that ranks write to a checkpoint, and those of a checkpoint with which they begin again.
#pragma once

#include <vector>

#include "delaunay/mesh.h"
#include "distributed/blocks.h"
#include "distributed/checkpoints.h"
#include "distributed/communication.h"
#include "distributed/learner.h"

namespace podm {

/// Returns the vertices in these cubes, without the corners of the virtual box.
std::vector<LearntVertex> shared_vertices(const Mesh& mesh, const CubeSet& cubes, std::size_t threads);

/// Collective. Returns the vertices of the checkpoint in this rank's block, and elsewhere the fewer the
/// farther away. The ranks of the checkpoint may have had other blocks.
std::vector<LearntVertex> vertices_to_restore(const Checkpoints& checkpoints, const Blocks& blocks,
                                              const CubeGrid& grid, Communication& ranks);

}  // namespace podm
