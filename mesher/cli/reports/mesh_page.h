// podm mesh --report: one page about a run and its mesh. A Python script makes it from the files of both.
#pragma once

#include "cli/commands/mesh_run.h"
#include "cli/processes/signal_thread.h"

namespace podm::cli {

/// Throws InputError if no page could be made for any mesh. Called before hours of meshing.
void check_page(const MeshCommand& command, const SignalThread& signals);

/// Writes the page of a run whose canonical mesh is written and measured. No partial page appears. Throws
/// InputError if that fails or a signal requests a stop.
void write_page(const MeshRun& run, const TetMesh& mesh, const SignalThread& signals);

}  // namespace podm::cli
