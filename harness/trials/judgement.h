// Judges a process by its end and by the record that it left.
#pragma once

#include <string>

#include "trials/trial.h"

namespace podm::bench {

/// Sets status, reason and record of a mesh that the process of `result` was asked to make.
void judge(const Trial& trial, const std::string& record_path, TrialResult& result);

/// Sets status, reason and record of a measurement of the machine.
void judge_measurement(const std::string& record_path, TrialResult& result);

}  // namespace podm::bench
