// The logs of a trial: what the mesher and the verifier wrote about its mesh, unchanged. A row quotes them,
// and a reader of rows compares both (submissions/check_logs.h).
#pragma once

#include <array>
#include <string>

#include "trials/input_files.h"
#include "trials/trial.h"
#include "trials/verification.h"

namespace podm::bench {

/// The mesher's record, the verifier's report and the mesher's messages. A trial without a mesh has only
/// some.
inline constexpr std::array kLogNames{kRecordName, kReportName, kMessagesName};

/// Returns the folder of the logs of the row with this key.
std::string logs_folder(const std::string& results_folder, const std::string& key);

/// Copies the logs from the folder of the trial, and replaces logs of an earlier row with this key. Throws
/// InputError.
void keep_logs(const std::string& scratch_folder, const std::string& results_folder, const std::string& key);

}  // namespace podm::bench
