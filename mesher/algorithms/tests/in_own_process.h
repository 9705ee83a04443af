// Runs a schedule in a process of its own: a broken triangulation may crash it or keep it from ending.
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace podm::test {

/// True if has_fault() returns true or crashes. A process that does not end within `most_seconds` does not
/// count.
template <class HasFault>
bool fails_in_own_process(unsigned most_seconds, const HasFault& has_fault) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    alarm(most_seconds);
    _exit(has_fault() ? 1 : 0);
  }
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("no process for a schedule");
  return status != 0 && !(WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM);
}

}  // namespace podm::test
