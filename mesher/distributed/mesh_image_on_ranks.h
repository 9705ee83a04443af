// A run on ranks that share no memory: the phases of one machine's run, with refinement in rounds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "distributed/communication.h"
#include "distributed/made_once.h"
#include "distributed/rounds.h"
#include "podm/mesh_image.h"
#include "podm/mesh_piece.h"

namespace podm {

/// What one rank did, and has of the mesh.
struct PartOfRank {
  std::uint64_t cells = 0, boundary_facets = 0;  ///< of its piece
  std::uint64_t store_cells = 0;                 ///< what its store held at the end
  std::map<std::string, double> phases_s;
  SpentByPhase spent;               ///< by the phases of rounds.h, "transform", "extract" and "measure"
  std::vector<RoundReport> rounds;  ///< none on one rank
  Update last_update;               ///< what completed its block
};

struct MeshingOnRanks {
  MeshPiece piece;              ///< this rank's
  std::uint64_t mesh_hash = 0;  ///< mesh_hash() of the whole, the same on all ranks
  /// The whole mesh's, the same on all ranks. Counters and store cells are sums, phases the means over ranks,
  /// which add up to the time that went by; "exchange" is what refinement took but for refining, waiting for
  /// others among it. Workers are all ranks', in their order.
  MeshingReport report;
  std::vector<PartOfRank> parts;  ///< by rank
};

using SharedIsosurface = MadeOnce<Isosurface>;

/// Throws InputError on what cannot be had on ranks: virtual workers, targets of cells, PODM at home,
/// schedules.
void check_options_on_ranks(const MeshingOptions& options);

/// Meshes `image` as mesh_image() does, with PODM in each rank's zone, leaf by leaf if asked; on one rank it
/// is the algorithm itself. Collective: image and options are the same on all ranks, but for threads and
/// memory, which are each rank's. A rank that makes more than its even share of what max_elements leaves
/// in a round ends the run. Throws RefusedByAll (distributed/together.h) where ranks have not the same, and
/// on options that are bad or not for ranks. Memory that runs out between rounds is std::bad_alloc on that
/// rank, and the others are to be ended. Ranks of one process may share the isosurface, and then have the
/// same image; else each makes its own.
MeshingOnRanks mesh_image_on_ranks(const LabelImage& image, const MeshingOptions& options,
                                   Communication& ranks, const ProgressCallback& progress = {},
                                   std::stop_token stop = {}, SharedIsosurface* isosurface = nullptr);

}  // namespace podm
