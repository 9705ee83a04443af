// A program whose standard output is read, and that never outlives this program.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "cli/processes/signal_thread.h"

namespace podm::cli {

/// A child process. It is among the leftovers until it is waited for.
class ChildProcess {
 public:
  /// Starts the program named by the command's first word, with the signal mask with which this program was
  /// started. Throws InputError, which begins with `asked_by`, if it cannot be run.
  ChildProcess(const std::vector<std::string>& command, const std::string& asked_by,
               const SignalThread& signals);
  /// Waits for the program.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns all of its standard output. Kills the program if a signal requests a stop.
  std::string read(const SignalThread& signals);
  /// Waits for the program. Returns its exit code; 128 or more if a signal ended it.
  int exit_code();

 private:
  int start(const std::vector<std::string>& command, int output, const SignalThread& signals);

  pid_t process_ = 0;
  int output_ = -1;
};

}  // namespace podm::cli
