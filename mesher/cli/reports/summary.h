// The summary that podm mesh prints at its end.
#pragma once

#include <string>

#include "cli/commands/mesh_run.h"

namespace podm::cli {

/// Returns several lines, each with a newline.
std::string summary(const MeshRun& run);

/// Returns one line per worker: operations by outcome, cells visited per operation, time lost, accesses by
/// distance.
std::string statistics(const MeshRun& run);

}  // namespace podm::cli
