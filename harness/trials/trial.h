// Runs the mesher once, as a child process, and collects its result.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "options/trial_settings.h"
#include "process/process.h"
#include "process/programs.h"
#include "rows/row.h"
#include "trials/counter_tool.h"
#include "trials/peer.h"
#include "trials/preparation.h"
#include "trials/verification.h"

namespace podm::bench {

struct TrialResult : TrialOutcome {
  Preparation preparation;         ///< the image that was read, and the radius
  std::optional<PeerRecord> peer;  ///< the mesher, if it is not podm
  ProcessOutcome process;
  Counters counters;                       ///< counts of the process
  std::optional<Measured> busy_elsewhere;  ///< processors that other work kept busy meanwhile
  std::uint64_t mesh_bytes = 0;            ///< size of the mesh file
  std::optional<ImageSize> image_size;     ///< unset if the mesher reports no size
};

/// The mesher's messages in the folder of a trial.
inline constexpr const char* kMessagesName = "/stderr.txt";

/// Runs trials one after the other.
class TrialRunner {
 public:
  explicit TrialRunner(Programs programs)
      : programs_(std::move(programs)), peers_(programs_.peers, programs_.podm) {}

  /// Returns the reason to skip a trial that cannot run here; empty: it can run.
  std::string why_skipped(const Trial& trial);

  /// Runs the mesher on the trial, then the verifier on its mesh, whose verdicts join the record, and the
  /// replay and the solver if they are requested. Writes files into `scratch_folder`, which must exist.
  TrialResult run(const Trial& trial, const Preparation& preparation, const std::string& scratch_folder,
                  const StopQuery& stop_requested = {});

 private:
  // The data that the steps of a trial share.
  struct Run;
  const std::optional<ImageSize>& image_size(const std::string& image);
  void make_mesh(const Run& run, TrialResult& result);
  // Measures the machine and makes no mesh.
  void measure(const Run& run, TrialResult& result);
  std::vector<std::string> command_of(const Run& run, const std::string& folder, TrialResult& result);
  // Returns null if the kernel counts.
  const CounterTool* counter_tool_of(const Run& run);
  void run_program(const Run& run, TrialResult& result);
  void run_copies(const Run& run, TrialResult& result);
  void prove(const Run& run, TrialResult& result);
  void replay(const Run& run, TrialResult& result);
  void solve(const Run& run, TrialResult& result);

  Programs programs_;
  Peers peers_;
  std::map<std::string, std::optional<ImageSize>> image_sizes_;        // each image is read once
  std::map<std::string, std::unique_ptr<CounterTool>> counter_tools_;  // each is asked once
  std::optional<std::string> absence_of_solver_;                       // it is asked once
};

}  // namespace podm::bench
