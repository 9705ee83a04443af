// podm-mpi mesh: podm mesh on ranks.
#pragma once

#include "cli/options/options.h"
#include "cli/processes/signal_thread.h"
#include "distributed/communication.h"
#include "distributed/made_once.h"
#include "distributed/mesh_image_on_ranks.h"

namespace podm::cli {

/// What the ranks of a process have in common.
struct SharedByRanks {
  MadeOnce<LabelImage> image;
  SharedIsosurface isosurface;
};

/// One rank's part. Collective. Returns the exit code, the same on all ranks: 0, or 1 when a guarantee or a
/// limit is unmet. Throws as mesh_image_on_ranks() does; rank 0 alone prints.
int mesh_on_ranks(MeshCommand command, Communication& ranks, SignalThread& signals, SharedByRanks& shared);

/// All of as many ranks as the command asks for in this process. Returns and throws as they do; what one rank
/// alone throws, as run_ranks() does.
int mesh_in_process(const MeshCommand& command, SignalThread& signals);

}  // namespace podm::cli
