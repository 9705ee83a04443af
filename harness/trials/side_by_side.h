// Several processes of one trial at the same time, each on a processor of its own. They share neither mesh
// nor image; their speed is therefore an upper bound for the same number of threads.
#pragma once

#include <string>

#include "trials/trial.h"

namespace podm::bench {

/// Returns the number of processes that the trial runs at the same time; 0: one process, not bound.
int num_copies(const Trial& trial);

/// Returns the folder of a copy, counted from 0. The first copy uses the folder of the trial.
std::string folder_of_copy(const std::string& scratch_folder, int copy);

/// Runs one request per copy. Sets the members of `result` from the first copy, and `side_by_side` from all.
/// A copy that fails, or that makes another mesh than the first, fails the trial.
void run_side_by_side(const Trial& trial, std::vector<ProcessRequest> requests,
                      const std::string& scratch_folder, const StopQuery& stop_requested,
                      TrialResult& result);

}  // namespace podm::bench
