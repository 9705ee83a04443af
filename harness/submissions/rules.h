// All rules that a submission keeps without any mesh being made again, and their faults in words.
#pragma once

#include <string>

#include "submissions/checks.h"

namespace podm::bench {

/// Reads the suite's experiments in a folder once for each number of processors.
ExperimentsOn experiments_in(const std::string& folder);

/// Applies all checks of checks.h.
void check_rules(const Submission& submission, const ExperimentsOn& experiments, Faults& faults);

/// "closed division, 12 rows of 3 experiments on 1 machine".
std::string describe(const Submission& submission);

/// One line per fault; of each rule only the first few, and the number of the others.
std::string describe(const Faults& faults);

}  // namespace podm::bench
