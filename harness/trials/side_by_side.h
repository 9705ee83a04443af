// Several processes of one trial at the same time, each on a processor of its own: what the machine gives as
// many threads at most that share neither mesh nor image.
#pragma once

#include <string>

#include "trials/trial.h"

namespace podm::bench {

/// Processes that the trial asks for at the same time; 0: one, wherever it likes.
int num_copies(const Trial& trial);

/// The files of a copy, from 0, are here. The first's are those of the trial.
std::string folder_of_copy(const std::string& scratch_folder, int copy);

/// Runs one request a copy and sets what `result` tells of the first, and of all `side_by_side`. Any that
/// does not do well, or makes another mesh than the first, is the trial's fault.
void run_side_by_side(const Trial& trial, std::vector<ProcessRequest> requests,
                      const std::string& scratch_folder, const StopQuery& stop_requested,
                      TrialResult& result);

}  // namespace podm::bench
