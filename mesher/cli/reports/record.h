// The JSON line that describes a run of podm mesh. Its names have the same meaning as in the project's trial
// records.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/commands/mesh_run.h"

namespace podm::cli {

inline constexpr int kRecordSchema = 1;

nlohmann::ordered_json record(const MeshRun& run);

}  // namespace podm::cli
