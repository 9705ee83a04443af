// One trial: the mesher run once as a child process, and what came of it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "experiment.h"
#include "process.h"
#include "verification.h"

namespace podm::bench {

inline constexpr int kRecordSchema = 1;  ///< of the mesher's records and of ours

enum class Status {
  kOk,
  kUnmet,   ///< a mesh, but a guarantee or limit is unmet or a claim not proved
  kFailed,  ///< no mesh, or no record of it
  kTimedOut,
  kInterrupted,  ///< by the user, as are all trials after it
  kSkipped,      ///< the image is absent and may be
};
/// "ok", "unmet", "failed", "timed_out", "interrupted", "skipped".
std::string to_string(Status status);

struct TrialResult {
  Status status = Status::kFailed;
  std::string reason;                ///< why the status is not kOk
  std::vector<std::string> command;  ///< as run
  ProcessOutcome process;
  std::string stderr_tail;            ///< of a trial that is not kOk
  nlohmann::ordered_json record;      ///< as the mesher wrote it; null when it did not
  nlohmann::ordered_json image_size;  ///< voxels per axis; null when the mesher could not tell
};

/// Runs the mesher on the trial, then the verifier on its mesh, whose verdicts join the record. Files are
/// written into `scratch_folder`, which must exist.
TrialResult run_trial(const Trial& trial, const Programs& programs, const std::string& scratch_folder,
                      const StopQuery& stop_requested = {});

}  // namespace podm::bench
