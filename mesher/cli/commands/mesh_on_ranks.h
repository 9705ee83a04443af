// podm-mpi mesh and podm-mpi replay: podm mesh and podm replay on ranks.
#pragma once

#include <functional>

#include "cli/options/options.h"
#include "cli/processes/signal_thread.h"
#include "distributed/communication.h"
#include "distributed/in_process_ranks.h"
#include "distributed/mesh_image_on_ranks.h"
#include "distributed/shared_value.h"

namespace podm::cli {

/// The objects that the ranks of a process share.
struct SharedByRanks {
  SharedValue<LabelImage> image;
  SharedInProcess meshing;
};

/// Runs one rank's part. Collective. Returns the exit code, the same on all ranks: 0, or 1 if the run misses
/// a guarantee or a limit. Throws as mesh_image_on_ranks() does. Only rank 0 prints.
int mesh_on_ranks(MeshCommand command, Communication& ranks, SignalThread& signals, SharedByRanks& shared);

/// Runs a collective command on all ranks in this process. Returns and throws as the command does on rank 0;
/// throws as run_ranks() does if only one rank throws.
int run_in_process(const InProcessOptions& options,
                   const std::function<int(Communication&, SharedByRanks&)>& command);
/// Runs as many ranks in this process as the command asks for.
int mesh_in_process(const MeshCommand& command, SignalThread& signals);

/// Replays the logs of a run, each rank its own. Collective. Returns the exit code, the same on all ranks: 0,
/// or 1 if the mesh differs. Throws as replay_on_ranks() does. Only rank 0 prints.
int replay_on_ranks(const ReplayCommand& command, Communication& ranks, SharedByRanks& shared);

int replay_in_process(const ReplayCommand& command);

}  // namespace podm::cli
