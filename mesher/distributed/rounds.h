// PODM on ranks that share no memory, in rounds. In each round every rank refines in its zone and sends the
// other ranks the vertices that it inserted and removed. (Feng, Chernikov, Chrisochoides, CAD 2018, use
// leaves as tasks and send sub-meshes. Here zones tile space and vertices are sent.)
//
//   1  Blocks divide space by predicted work.
//   2  Each rank inserts the seeds in its block and around it, a coarse lattice (lattice_seeds.h). No vertex
//      is sent, because all ranks compute the same seeds.
//   3  In round 0 a rank's zone is its block. The rank refines the cells whose least vertices are in the
//      block, by PODM alone or leaf by leaf first (leaves_of_zone.h). A cell that needs vertices outside is
//      deferred.
//   4  In rounds 1 to 4 the zones are shifted blocks. In later rounds zones surround the deferred cells that
//      are left (zones_of_round.h). They become wider from round to round. When one zone fills space its rank
//      knows all vertices and defers nothing; therefore the rounds end.
//   5  R7 moves vertices in rounds with the same zones, if it is requested (refine/perturbation.h).
//   6  At the end each rank learns what other ranks changed in its block and around it.
//
// Between rounds of R1 to R6 the ranks may write checkpoints (checkpoints.h). A resumed run has the vertices
// of a checkpoint in place of the seeds, and applies PODM to all cells in its round 0.
//
// A signal or a limit, except that of cells, which ends the work of one rank in a round soon ends that of all
// (end_on_all_ranks.h).
//
// After each of these exchanges the ranks compare what they have where they overlap (overlap.h).
#pragma once

#include "algorithms/podm.h"
#include "distributed/blocks.h"
#include "distributed/checkpoints.h"
#include "distributed/communication.h"
#include "distributed/end_on_all_ranks.h"
#include "distributed/spending.h"
#include "distributed/vertex_source.h"
#include "podm/operation_log.h"

namespace podm {

/// One round, on this rank unless a member says otherwise.
struct RoundReport {
  std::uint64_t entries = 0;  ///< cells at its start
  std::uint64_t insertions = 0;
  std::uint64_t in_leaves = 0;  ///< part of the insertions
  std::uint64_t deferred = 0;   ///< cells, on all ranks
  std::uint64_t cubes = 0;      ///< cubes of its zone
  Update update;                ///< update before it
  /// Seconds of computing, as Communication counts them: processor seconds of all threads over MPI.
  double update_s = 0, refine_s = 0;
};

struct DistributedRefinement {
  Refinement refinement;  ///< the mesh is correct in this rank's block and around it
  CubeGrid grid;
  Blocks blocks;                                       ///< by rank
  CubesOfRank cubes = {};                              ///< this rank's; none if there is one rank
  std::vector<RoundReport> rounds, perturbing_rounds;  ///< those of R1 to R6, and those of R7
  std::uint64_t seeds = 0;  ///< vertices that this rank inserted before round 0, also those of a checkpoint
  Update last_update;
  /// This rank's time per phase: "initial", blocks and seeds; "refine", round 0; "later", refining in later
  /// rounds; "perturb", R7 in all rounds; "exchange", everything else.
  SpentByPhase spent = {};
};

struct DistributedOptions {
  double initial_ratio = 4;    ///< as in LeafOptions
  std::uint64_t cut_seed = 0;  ///< draws the cuts between blocks; 0: cuts follow the predicted work
  Algorithm algorithm = Algorithm::kPodm;  ///< kPodm, or kPdr or kPdrPodm: leaves first, in round 0
  double leaf_size_mm = 0;                 ///< as in LeafOptions
  Checkpoints* checkpoints = nullptr;      ///< none: no checkpoint is written or resumed
  EndOnAllRanks* end = nullptr;            ///< none: a rank hears of the ends of others between rounds
};

/// Refines the mesh on all ranks. Collective. All ranks have the same problem and options, and each has its
/// own team.
DistributedRefinement podm_distributed(const Problem& problem, const Team& team,
                                       const DistributedOptions& options, Communication& ranks,
                                       StopControl& stop);

}  // namespace podm
