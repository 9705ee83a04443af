// A run of the verifier: reads the inputs, checks the claims, writes the reports.
#pragma once

#include <functional>

#include "command_line.h"
#include "mesh.h"
#include "ranks/communication.h"

namespace podm::verify {

/// Collective. `read` returns the mesh, or the rank's part of it; the first rank writes the reports. Returns
/// the exit code, kSuccess or kClaimNotMet. Throws RefusedByAll.
int verify(const Command& command, Communication& ranks, const std::function<Mesh()>& read,
           bool shows_progress);

}  // namespace podm::verify
