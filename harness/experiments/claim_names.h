// Names of claims are permanent ids.
#pragma once

#include <vector>

#include "experiments/experiment.h"

namespace podm::bench {

/// Throws InputError that names both places if two claims of the experiments, current or withdrawn, have the
/// same name.
void check_claim_names(const std::vector<Experiment>& experiments);

}  // namespace podm::bench
