// A program that is started to tell something on its standard output, and that never outlives this one.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "cli/processes/signal_thread.h"

namespace podm::cli {

/// It is among the leftovers until it is waited for.
class ChildProcess {
 public:
  /// Starts the program named by the command's first word, with the signal mask that this one was started
  /// with. Throws InputError, which begins with `asked_by`, where it cannot be run.
  ChildProcess(const std::vector<std::string>& command, const std::string& asked_by,
               const SignalThread& signals);
  /// Waits for it.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// All of its standard output, until it ends, of itself or because a signal asks for that.
  std::string read(const SignalThread& signals);
  /// Waits for it. Its exit code; 128 and more where a signal has ended it.
  int exit_code();

 private:
  int start(const std::vector<std::string>& command, int output, const SignalThread& signals);

  pid_t process_ = 0;
  int output_ = -1;
};

}  // namespace podm::cli
