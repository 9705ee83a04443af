// What a person reads at the end of podm mesh.
#pragma once

#include <string>

#include "cli/mesh_run.h"

namespace podm::cli {

/// Several lines, each ended.
std::string summary(const MeshRun& run);

}  // namespace podm::cli
