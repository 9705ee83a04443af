// The replay of a distributed run without a machine that holds the whole mesh: each rank replays its own log.
// (podm replay merges the logs of all ranks into one serial run instead.) Together the checks prove that the
// mesh of the run is the Delaunay mesh of the vertices that a serial run of all operations leaves:
//
//   1  A rank carries out its own operations, and what it learnt, on the triangulation of the vertices that
//      it has. Each operation must fit, as in the replay of a run on one machine.
//   2  Every vertex has one history. The rank with the point in its block receives what all logs say of the
//      point, and follows it step by step. In one step only one rank may change the point. Who learns of a
//      vertex, or of its removal, must learn what the steps before have left.
//   3  At the end each rank has exactly the vertices of the whole in the cubes that it claims to know. Every
//      cell that its piece reads must have its ball in these cubes, and is then a cell of the whole (zone.h).
//   4  Every cube is in one block, so each cell of the whole is counted by one rank. The hashes of the ranks'
//      cells and facets add up to the hash of the whole mesh.
//
// That a removed vertex was near the new one is checked in the rank's own triangulation only.
#pragma once

#include "distributed/communication.h"
#include "distributed/shared_value.h"
#include "isosurface/isosurface.h"
#include "podm/meshing_options.h"
#include "podm/operation_log.h"

namespace podm {

/// Numbers of all ranks together.
struct ReplayOnRanks {
  std::uint64_t operations = 0;  ///< without what ranks learnt and without seeds
  std::uint64_t seeds = 0, cells = 0;
  std::uint64_t mesh_hash = 0;
};

/// Replays the log of this rank of at least two. Collective. Ranks of one process may share the isosurface.
/// Throws RefusedByAll if the logs are of different runs or of another number of ranks, if an entry cannot be
/// carried out, or if the logs contradict each other.
ReplayOnRanks replay_on_ranks(const LabelImage& image, const OperationLog& own, Space space, int threads,
                              Communication& ranks, SharedValue<Isosurface>& isosurface);

}  // namespace podm
