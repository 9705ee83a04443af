// Names of claims are their ids for life.
#pragma once

#include <vector>

#include "experiments/experiment.h"

namespace podm::bench {

/// Throws InputError naming both places where two claims of the experiments, made or withdrawn, have one
/// name.
void check_claim_names(const std::vector<Experiment>& experiments);

}  // namespace podm::bench
