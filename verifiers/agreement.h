// The comparison of what ranks were given. Ranks with other inputs would judge parts of the mesh differently,
// or call other collectives. All functions are collective and throw RefusedByAll, naming file and rank.
#pragma once

#include "options.h"
#include "ranks/communication.h"
#include "run_claims.h"

namespace podm::verify {

/// Compares the mesh files that list the pieces.
void expect_same_index(const Options& options, Communication& ranks);
/// Compares images, as they were read because a header may name other files, and the schedule.
void expect_same_inputs(const Inputs& inputs, const Options& options, Communication& ranks);

}  // namespace podm::verify
