// podm-mpi mesh: podm mesh on ranks.
#pragma once

#include "cli/options/options.h"
#include "cli/processes/signal_thread.h"
#include "distributed/communication.h"
#include "distributed/mesh_image_on_ranks.h"
#include "distributed/shared_value.h"

namespace podm::cli {

/// The objects that the ranks of a process share.
struct SharedByRanks {
  SharedValue<LabelImage> image;
  SharedIsosurface isosurface;
};

/// Runs one rank's part. Collective. Returns the exit code, the same on all ranks: 0, or 1 if the run misses
/// a guarantee or a limit. Throws as mesh_image_on_ranks() does. Only rank 0 prints.
int mesh_on_ranks(MeshCommand command, Communication& ranks, SignalThread& signals, SharedByRanks& shared);

/// Runs all ranks in this process, as many as the command asks for. Returns and throws as mesh_on_ranks()
/// does; throws as run_ranks() does if only one rank throws.
int mesh_in_process(const MeshCommand& command, SignalThread& signals);

}  // namespace podm::cli
