// A run of the verifier: reads the inputs, checks the claims, writes the reports.
#pragma once

#include "command_line.h"

namespace podm::verify {

/// Returns the exit code: kSuccess or kClaimNotMet. Throws InputError.
int verify(const Command& command, bool shows_progress);

}  // namespace podm::verify
