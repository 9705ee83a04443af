// One trial: the mesher run once as a child process, and what came of it.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "experiments/experiment.h"
#include "peers/peer.h"
#include "trials/counter_tool.h"
#include "trials/preparation.h"
#include "trials/process.h"
#include "trials/verification.h"

namespace podm::bench {

inline constexpr const char* kRecordName = "/record.jsonl";  ///< in the folder of a trial

enum class Status {
  kOk,
  kUnmet,   ///< a mesh, but a guarantee or limit is unmet or a claim not proved
  kFailed,  ///< no mesh, or no record of it
  kTimedOut,
  kInterrupted,  ///< by the user, as are all trials after it
  kSkipped,      ///< it cannot run here and need not
};
/// "ok", "unmet", "failed", "timed_out", "interrupted", "skipped".
std::string to_string(Status status);

struct TrialResult {
  Status status = Status::kFailed;
  std::string reason;                ///< why the status is not kOk
  Preparation preparation;           ///< the image that was read, and the radius
  std::vector<std::string> command;  ///< as run
  nlohmann::ordered_json peer;       ///< name, hash and version of a mesher other than podm; else null
  ProcessOutcome process;
  nlohmann::ordered_json counters = nlohmann::ordered_json::object();  ///< of the process
  std::uint64_t mesh_bytes = 0;                                        ///< of the mesh file
  double preparation_s = 0, verification_s = 0;  ///< before the mesher starts and after it has ended
  std::string stderr_tail;                       ///< of a trial that is not kOk
  nlohmann::ordered_json record;                 ///< as the program wrote it; null when it did not
  nlohmann::ordered_json image_size;             ///< voxels per axis; null when the mesher could not tell
  nlohmann::ordered_json replay;        ///< "equal", "differs" or "failed: why"; null when not asked for
  nlohmann::ordered_json side_by_side;  ///< an entry a copy; null where the trial asks for none
};

/// Runs trials one after the other.
class TrialRunner {
 public:
  explicit TrialRunner(Programs programs)
      : programs_(std::move(programs)), peers_(programs_.peers, programs_.podm) {}

  /// Why the trial cannot run here and need not; empty: it can.
  std::string why_skipped(const Trial& trial);

  /// Runs the mesher on the trial, then the verifier on its mesh, whose verdicts join the record, and the
  /// replay where it is asked for. Files are written into `scratch_folder`, which must exist.
  TrialResult run(const Trial& trial, const Preparation& preparation, const std::string& scratch_folder,
                  const StopQuery& stop_requested = {});

 private:
  // What a trial's steps have in common.
  struct Run;
  const nlohmann::ordered_json& image_size(const std::string& image);
  void make_mesh(const Run& run, TrialResult& result);
  // Of the machine, no mesh.
  void measure(const Run& run, TrialResult& result);
  std::vector<std::string> command_of(const Run& run, const std::string& folder, TrialResult& result);
  // Null: the kernel counts.
  const CounterTool* counter_tool_of(const Run& run);
  void run_program(const Run& run, TrialResult& result);
  void run_copies(const Run& run, TrialResult& result);
  void prove(const Run& run, TrialResult& result);

  Programs programs_;
  Peers peers_;
  std::map<std::string, nlohmann::ordered_json> image_sizes_;          // each image is looked at once
  std::map<std::string, std::unique_ptr<CounterTool>> counter_tools_;  // each is asked once
};

}  // namespace podm::bench
