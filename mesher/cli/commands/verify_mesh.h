// podm mesh --verify: verification of the written mesh by podm-verify, a program that shares no code with the
// mesher.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/commands/mesh_run.h"
#include "cli/processes/signal_thread.h"

namespace podm::cli {

/// Throws InputError if podm-verify cannot be run, or if it cannot verify the requested mesh.
void check_verifier(const MeshCommand& command);

/// The claims of podm-verify that the mesh of a run promises, and the options with their bounds: all that
/// podm-verify needs beside the mesh and the image.
struct Judging {
  std::vector<std::string> claims, options;
};
/// Fidelity is among the claims where --verify-fidelity asks for it.
Judging judging_of(const MeshRun& run);

/// The options by which podm-verify checks that. Image and labels are those of the image's file; if there is
/// none `write_image` is called, which writes the image with its labels selected, and returns the name of the
/// file.
std::vector<std::string> verifier_options(const MeshRun& run,
                                          const std::function<std::string()>& write_image);

/// Runs the podm-verify beside this program on the mesh that `run` wrote. It checks all claims; fidelity only
/// on request, because fidelity is promised only for cells about as small as voxels. The verifier gets the
/// image file with the options that selected its labels. A phantom is first written to a file beside the
/// mesh. The readable report goes to standard error unless the run is quiet. Returns the report of
/// podm-verify --json, or null if a signal ended the verifier or came before it. Throws InputError if the
/// verifier is missing or reports nothing.
JsonPointer verify_mesh(const MeshRun& run, const SignalThread& signals);

}  // namespace podm::cli
