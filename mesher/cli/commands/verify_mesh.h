// podm mesh --verify: the written mesh handed to podm-verify, a program that shares no code with the mesher.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands/mesh_run.h"
#include "cli/processes/signal_thread.h"

namespace podm::cli {

/// Throws InputError where there is no podm-verify that can be run, or none that can judge what is asked for.
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

/// Runs the podm-verify beside this program on the mesh that `run` wrote: all claims but fidelity, which is
/// promised only for cells about as small as voxels. The image goes with it as it is in its file, with the
/// options that selected its labels; a phantom as a file beside the mesh, written for the purpose. The report
/// for people goes to standard error unless the run is quiet. Returns that of podm-verify --json, null where
/// a signal has ended it or came before; throws InputError where the verifier is not there or tells nothing.
nlohmann::ordered_json verify_mesh(const MeshRun& run, const SignalThread& signals);

}  // namespace podm::cli
