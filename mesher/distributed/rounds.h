// PODM on ranks that share no memory: rounds in which each rank refines in its zone, and tells others what
// vertices it made and took away. (Feng, Chernikov, Chrisochoides, CAD 2018, have leaves as tasks and ship
// sub-meshes; here zones tile space and vertices travel.)
//
//   1  The first rank makes a coarse mesh, and all get its vertices.
//   2  Blocks divide space by predicted work. In round 0 a rank's zone is its block, and it refines the
//      cells that have their least vertices there, by PODM alone or leaf by leaf first (leaves_of_zone.h). A
//      cell that needs vertices outside is deferred.
//   3  In later rounds zones are around what waits (zones_of_round.h), other ones each time, and ever wider.
//      When one fills space its rank knows all and defers nothing: so rounds end.
//   4  At the end each rank learns what others changed in its block, and around it.
#pragma once

#include "algorithms/podm.h"
#include "distributed/blocks.h"
#include "distributed/communication.h"
#include "distributed/spending.h"
#include "distributed/vertex_exchange.h"

namespace podm {

/// A round, on this rank unless it says otherwise.
struct RoundReport {
  std::uint64_t entries = 0;  ///< cells that it began with
  std::uint64_t insertions = 0;
  std::uint64_t in_leaves = 0;  ///< of the insertions
  std::uint64_t deferred = 0;   ///< cells, on all ranks
  std::uint64_t cubes = 0;      ///< of its zone
  Update update;                ///< before it
  double update_s = 0, refine_s = 0;
};

struct DistributedRefinement {
  Refinement refinement;  ///< the mesh is right in this rank's block and around it
  CubeGrid grid;
  std::vector<int> rank_of_cube;  ///< by the blocks
  std::vector<RoundReport> rounds;
  Update last_update;
  /// This rank's: "initial", the coarse mesh or what it learns of it, and blocks; "refine", round 0; "later",
  /// refining in later rounds; "exchange", all else.
  SpentByPhase spent = {};
};

struct DistributedOptions {
  double initial_ratio = 4;                ///< bounds of the coarse mesh over the final ones
  std::uint64_t cut_seed = 0;              ///< draws where blocks are cut; 0: by predicted work
  Algorithm algorithm = Algorithm::kPodm;  ///< or kPdr or kPdrPodm: leaves first, in round 0
  double leaf_size_mm = 0;                 ///< as in LeafOptions
};

/// Collective. All ranks have the same problem and options, each a team of its own.
DistributedRefinement podm_distributed(const Problem& problem, const Team& team,
                                       const DistributedOptions& options, Communication& ranks,
                                       StopControl& stop);

}  // namespace podm
