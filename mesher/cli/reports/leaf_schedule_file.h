// The schedule file of a run that refined leaf by leaf, as podm-verify reads it: JSON lines
// "podm-schedule/1".
#pragma once

#include <string>

#include "cli/commands/mesh_run.h"

namespace podm::cli {

/// Throws InputError if the file cannot be written.
void write_schedule(const MeshRun& run, const std::string& path);

}  // namespace podm::cli
