// What a person reads at the end of an experiment.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "trial.h"

namespace podm::bench {

/// Columns aligned, one line a trial, each line ended. Seconds are those of all phases but writing.
std::string format_table(const std::vector<std::pair<Trial, TrialResult>>& results);

/// Of all phases of a mesher's record but writing, as in the paper's eq. (1).
double meshing_seconds(const nlohmann::ordered_json& record);

}  // namespace podm::bench
