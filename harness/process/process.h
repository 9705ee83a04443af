// Running a program as a child process and measuring what it took.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "process/stop_request.h"

namespace podm::bench {

struct ProcessRequest {
  std::vector<std::string> arguments;    ///< the program first; looked up in PATH unless it has a slash
  std::string stdout_path, stderr_path;  ///< overwritten; empty: thrown away
  double timeout_s = 0;                  ///< killed after it; 0: never
  std::uint64_t memory_limit_bytes = 0;  ///< killed when its resident memory is seen above it; 0: never
  std::optional<int> processor = {};     ///< it may run on this one alone; nothing: where this process may
};

struct ProcessOutcome {
  enum class End { kExited, kSignalled, kTimedOut, kOutOfMemory, kInterrupted, kNotStarted };
  End end = End::kNotStarted;
  int exit_code = 0;        ///< when kExited
  int signal = 0;           ///< when kSignalled
  std::string start_error;  ///< when kNotStarted: the system's reason
  double wall_s = 0, user_s = 0, system_s = 0;
  std::uint64_t peak_rss_bytes = 0, page_faults = 0, context_switches = 0;

  bool succeeded() const { return end == End::kExited && exit_code == 0; }
  /// How it ended, e.g. "exit code 2" or "killed by signal 11 (Segmentation fault)".
  std::string describe() const;
};

/// Runs to the end, a limit or a stop request; the latter two kill the child and its descendants. The child
/// dies with this process, however that ends.
ProcessOutcome run_process(const ProcessRequest& request, const StopQuery& stop_requested = {});

/// Runs several at the same time in the same way, until the last has ended.
std::vector<ProcessOutcome> run_processes(const std::vector<ProcessRequest>& requests,
                                          const StopQuery& stop_requested = {});

/// Whether a program of this name is in PATH.
bool is_installed(const std::string& program);

/// The end of a text file, at most `max_bytes` of it; empty when there is none.
std::string read_tail(const std::string& path, std::size_t max_bytes);

}  // namespace podm::bench
