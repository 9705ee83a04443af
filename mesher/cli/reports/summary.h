// What a person reads at the end of podm mesh.
#pragma once

#include <string>

#include "cli/commands/mesh_run.h"

namespace podm::cli {

/// Several lines, each ended.
std::string summary(const MeshRun& run);

/// One line a worker: operations by outcome, cells visited an operation, time lost, accesses by distance.
std::string statistics(const MeshRun& run);

}  // namespace podm::cli
