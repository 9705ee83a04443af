// Runs programs as child processes and measures their time and memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "process/stop_request.h"

namespace podm::bench {

struct ProcessRequest {
  std::vector<std::string> arguments;    ///< the program first, looked up in PATH unless it contains a slash
  std::string stdout_path, stderr_path;  ///< overwritten; empty: output is discarded
  double timeout_s = 0;                  ///< killed after it; 0: no limit
  std::uint64_t memory_limit_bytes = 0;  ///< killed when its resident memory is seen above it; 0: no limit
  std::optional<int> processor = {};     ///< bound to this one; unset: it inherits this process's set
};

struct ProcessOutcome {
  enum class End { kExited, kSignalled, kTimedOut, kOutOfMemory, kInterrupted, kNotStarted };
  End end = End::kNotStarted;
  int exit_code = 0;        ///< if kExited
  int signal = 0;           ///< if kSignalled
  std::string start_error;  ///< if kNotStarted: the system's reason
  double wall_s = 0, user_s = 0, system_s = 0;
  std::uint64_t peak_rss_bytes = 0, page_faults = 0, context_switches = 0;

  bool succeeded() const { return end == End::kExited && exit_code == 0; }
  /// Describes the end, e.g. "exit code 2" or "killed by signal 11 (Segmentation fault)".
  std::string describe() const;
};

/// Runs the process until it ends, reaches a limit or is stopped by request. A limit or a request kills the
/// child and its descendants. The child dies with this process, however this process ends.
ProcessOutcome run_process(const ProcessRequest& request, const StopQuery& stop_requested = {});

/// Runs several processes at the same time in the same way, until the last one has ended.
std::vector<ProcessOutcome> run_processes(const std::vector<ProcessRequest>& requests,
                                          const StopQuery& stop_requested = {});

/// True if a program of this name is in PATH.
bool is_installed(const std::string& program);

/// Returns the last `max_bytes` bytes of a text file, or all of a shorter one; empty when there is no file.
std::string read_tail(const std::string& path, std::size_t max_bytes);

}  // namespace podm::bench
