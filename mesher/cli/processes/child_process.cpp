#include "cli/processes/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "files/leftovers.h"
#include "podm/errors.h"

extern char** environ;

namespace podm::cli {

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::string& asked_by,
                           const SignalThread& signals) {
  std::array<int, 2> ends;
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw InputError(asked_by + ": cannot create a pipe");
  output_ = ends[0];
  const int error = start(command, ends[1], signals);
  ::close(ends[1]);
  if (error == 0) return;
  ::close(output_);
  throw InputError(fmt::format("{}: {} cannot be run", asked_by, command[0]));
}

// Keeps the process number reserved until it is no longer among the leftovers.
ChildProcess::~ChildProcess() {
  ::close(output_);
  exit_code();
  HeldLeftovers leftovers;
  waitpid(process_, nullptr, 0);
  leftovers.drop_child(process_);
}

std::string ChildProcess::read(const SignalThread& signals) {
  const std::stop_callback end_it(signals.token(), [this] { kill(process_, SIGKILL); });
  std::string text;
  std::array<char, 4096> part;
  for (;;) {
    const ssize_t count = ::read(output_, part.data(), part.size());
    if (count == 0 || (count < 0 && errno != EINTR)) return text;
    if (count > 0) text.append(part.data(), static_cast<std::size_t>(count));
  }
}

int ChildProcess::exit_code() {
  siginfo_t ended{};
  while (waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  return ended.si_code == CLD_EXITED ? ended.si_status : 128 + ended.si_status;
}

int ChildProcess::start(const std::vector<std::string>& command, int output, const SignalThread& signals) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &signals.mask_before());
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  HeldLeftovers leftovers;
  const int error = posix_spawn(&process_, arguments[0], &actions, &attributes, arguments.data(), environ);
  if (error == 0) leftovers.add_child(process_);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return error;
}

}  // namespace podm::cli
