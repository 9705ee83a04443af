// A run on ranks that share no memory. It has the phases of a run on one machine, with refinement in rounds.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "distributed/checkpoints.h"
#include "distributed/communication.h"
#include "distributed/rounds.h"
#include "distributed/shared_value.h"
#include "podm/mesh_image.h"
#include "podm/mesh_piece.h"

namespace podm {

/// One rank's work and its part of the mesh.
struct PartOfRank {
  std::uint64_t cells = 0, boundary_facets = 0;  ///< numbers in its piece
  std::uint64_t store_cells = 0;                 ///< number in its store at the end
  std::map<std::string, double> phases_s;
  SpentByPhase spent;  ///< by the phases of rounds.h, and others: "transform", "calibrate" if
                       ///< there is a target, "extract" and "measure"
  std::vector<RoundReport> rounds, perturbing_rounds;  ///< of R1 to R6, and of R7; empty on one rank
  std::uint64_t seeds = 0;                             ///< as in DistributedRefinement
  Update last_update;                                  ///< the update that completed its block
  /// Memory of the parts of the image that were read when they were first needed. Ranks of a process share
  /// it.
  std::uint64_t image_bytes_read = 0;
};

/// The checkpoint with which a run began.
struct ResumedFrom {
  std::uint64_t rounds = 0;  ///< carried out before, in all runs
  std::uint64_t ranks = 0;   ///< that wrote it
};

struct MeshingOnRanks {
  MeshPiece piece;              ///< this rank's piece
  std::uint64_t mesh_hash = 0;  ///< mesh_hash() of the whole mesh, the same on all ranks
  CubesOfRank cubes;            ///< this rank's; none if there is one rank
  /// The report on the whole mesh, the same on all ranks. Counters and store cells are sums. Phases are means
  /// over ranks, which add up to the elapsed time. "exchange" is the part of refinement that is not refining,
  /// including waiting for other ranks. The workers of all ranks are listed in the order of the ranks. Only
  /// the seconds of single trial meshes are those of this rank.
  MeshingReport report;
  std::vector<PartOfRank> parts;  ///< by rank
  std::optional<ResumedFrom> resumed;
};

/// A rank of a process may hold up to this many times as many cells as fit in its own part of the memory.
inline constexpr std::size_t kMostShares = 8;

/// The objects that the ranks of one process share.
struct SharedInProcess {
  SharedValue<Isosurface> isosurface;
  SharedIds cells;  ///< of all stores; mesh_image_on_ranks() adds those that fit in each rank's memory
};

/// Throws InputError on options that ranks do not support: kPodmHome, schedules, optimisation, and virtual
/// workers unless the calling thread has virtual threads (runtime/virtual_threads.h).
void check_options_on_ranks(const MeshingOptions& options);

/// Meshes `image` as mesh_image() does, with PODM in each rank's zone, leaf by leaf if requested. On one rank
/// it runs the algorithm itself. Collective: image and options are the same on all ranks, except threads and
/// memory, which each rank chooses. Ranks share the rest of max_elements in proportion to the cells that they
/// begin a round with. A rank that exceeds its share ends the run. Throws RefusedByAll
/// (distributed/collective_errors.h) if images or options differ between ranks, or if options are bad or not
/// supported on ranks. If memory runs out between rounds, that rank throws OutOfMemory
/// (distributed/rank_failure.h), which names a number of ranks that would do, and the caller must end the
/// other ranks. Ranks of one process that have the same image may share objects. A rank then holds more cells
/// than fit in its own memory if others leave theirs unused, up to kMostShares times as many. Checkpoints
/// need two ranks or more, and a radius; one rank may resume those of more. Throws RefusedByAll on faults of
/// their files.
MeshingOnRanks mesh_image_on_ranks(const LabelImage& image, const MeshingOptions& options,
                                   Communication& ranks, const ProgressCallback& progress = {},
                                   std::stop_token stop = {}, SharedInProcess* shared = nullptr,
                                   const CheckpointOptions& checkpoints = {});

}  // namespace podm
