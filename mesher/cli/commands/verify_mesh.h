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

/// The options of podm-verify by which it checks what the run promises of its mesh. Image and labels are
/// those of the image's file; if it has none `write_image` is called, which writes it, with its labels
/// selected, to a file whose name it returns.
std::vector<std::string> claims_to_verify(const MeshRun& run,
                                          const std::function<std::string()>& write_image);

/// Runs the podm-verify beside this program on the mesh that `run` wrote: all claims but fidelity, which is
/// promised only for cells about as small as voxels. The image goes with it as it is in its file, with the
/// options that selected its labels; a phantom as a file beside the mesh, written for the purpose. The report
/// for people goes to standard error unless the run is quiet. Returns that of podm-verify --json, null where
/// a signal has ended it or came before; throws InputError where the verifier is not there or tells nothing.
nlohmann::ordered_json verify_mesh(const MeshRun& run, const SignalThread& signals);

}  // namespace podm::cli
