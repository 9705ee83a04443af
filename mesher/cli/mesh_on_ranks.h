// podm-mpi mesh: podm mesh on ranks.
#pragma once

#include "cli/options.h"
#include "cli/signal_thread.h"
#include "distributed/communication.h"

namespace podm::cli {

/// One rank's part. Collective. Returns the exit code, the same on all ranks: 0, or 1 when a guarantee or a
/// limit is unmet. Throws as mesh_image_on_ranks() does; rank 0 alone prints.
int mesh_on_ranks(MeshCommand command, Communication& ranks, SignalThread& signals);

}  // namespace podm::cli
