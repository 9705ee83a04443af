// One trial: the mesher run once as a child process, and what came of it.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "counter_tool.h"
#include "experiment.h"
#include "peer.h"
#include "process.h"
#include "verification.h"

namespace podm::bench {

inline constexpr int kMesherSchema = 1;  ///< of the mesher's records

enum class Status {
  kOk,
  kUnmet,   ///< a mesh, but a guarantee or limit is unmet or a claim not proved
  kFailed,  ///< no mesh, or no record of it
  kTimedOut,
  kInterrupted,  ///< by the user, as are all trials after it
  kSkipped,      ///< the image is absent and may be, or the peer is not installed
};
/// "ok", "unmet", "failed", "timed_out", "interrupted", "skipped".
std::string to_string(Status status);

struct TrialResult {
  Status status = Status::kFailed;
  std::string reason;                ///< why the status is not kOk
  std::vector<std::string> command;  ///< as run
  nlohmann::ordered_json peer;       ///< name, hash and version of a mesher other than podm; else null
  ProcessOutcome process;
  nlohmann::ordered_json counters = nlohmann::ordered_json::object();  ///< of the process
  std::uint64_t mesh_bytes = 0;                                        ///< of the mesh file
  double preparation_s = 0, verification_s = 0;  ///< before the mesher starts and after it has ended
  std::string stderr_tail;                       ///< of a trial that is not kOk
  nlohmann::ordered_json record;                 ///< as the program wrote it; null when it did not
  nlohmann::ordered_json image_size;             ///< voxels per axis; null when the mesher could not tell
};

/// Runs trials one after the other.
class TrialRunner {
 public:
  explicit TrialRunner(Programs programs)
      : programs_(std::move(programs)), peers_(programs_.peers, programs_.podm) {}

  /// Runs the mesher on the trial, then the verifier on its mesh, whose verdicts join the record. Files are
  /// written into `scratch_folder`, which must exist.
  TrialResult run(const Trial& trial, const std::string& scratch_folder,
                  const StopQuery& stop_requested = {});

 private:
  const nlohmann::ordered_json& image_size(const std::string& image, const std::string& scratch_folder);
  // Status kSkipped and the reason where the trial cannot run here.
  bool skip(const Trial& trial, TrialResult& result);
  void make_mesh(const Trial& trial, const std::string& scratch_folder, const StopQuery& stop_requested,
                 TrialResult& result);
  // Of the machine, no mesh.
  void measure(const Trial& trial, const std::string& scratch_folder, const StopQuery& stop_requested,
               TrialResult& result);
  void set_command(const Trial& trial, const std::string& scratch_folder, TrialResult& result);
  // Null: the kernel counts.
  const CounterTool* counter_tool_of(const Trial& trial, const std::string& scratch_folder);
  void run_program(const Trial& trial, const std::string& scratch_folder, const StopQuery& stop_requested,
                   TrialResult& result);
  void verify(const Trial& trial, const std::string& scratch_folder, const StopQuery& stop_requested,
              TrialResult& result);

  Programs programs_;
  Peers peers_;
  std::map<std::string, nlohmann::ordered_json> image_sizes_;          // each image is looked at once
  std::map<std::string, std::unique_ptr<CounterTool>> counter_tools_;  // each is asked once
};

}  // namespace podm::bench
