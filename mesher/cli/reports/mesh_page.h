// podm mesh --report: one page about a run and its mesh, made by a Python script from the files of both.
#pragma once

#include "cli/commands/mesh_run.h"
#include "cli/processes/signal_thread.h"

namespace podm::cli {

/// Throws InputError where no page could be made, whatever the mesh: before hours of meshing.
void check_page(const MeshCommand& command, const SignalThread& signals);

/// Writes the page, whole or not at all, of a run whose mesh, canonical, is written and measured. Throws
/// InputError where that fails or a signal asks for an end.
void write_page(const MeshRun& run, const TetMesh& mesh, const SignalThread& signals);

}  // namespace podm::cli
