#include "process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>

extern "C" {  // missing in the header of glibc 2.36
#include <sys/pidfd.h>
}

namespace podm::bench {
namespace {

using Clock = std::chrono::steady_clock;
using End = ProcessOutcome::End;

constexpr int kPollMs = 100;  // how late a stop request or the time limit may be seen; an end is seen at once
constexpr int kPollWithoutDescriptorMs = 1;  // an end is then seen this late

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// The child leads a group of its own: a kill reaches its children too, a Ctrl-C at the terminal does not.
class SpawnSetup {
 public:
  explicit SpawnSetup(const ProcessRequest& request) {
    posix_spawn_file_actions_init(&files_);
    posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    redirect(STDOUT_FILENO, request.stdout_path);
    redirect(STDERR_FILENO, request.stderr_path);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes_, 0);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&files_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;

  // 0 or the number of the error, that of a failed exec included.
  int spawn(std::vector<std::string> arguments, pid_t& pid) const {
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    return posix_spawnp(&pid, pointers.front(), &files_, &attributes_, pointers.data(), environ);
  }

 private:
  void redirect(int descriptor, const std::string& path) {
    posix_spawn_file_actions_addopen(&files_, descriptor, path.empty() ? "/dev/null" : path.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0666);
  }

  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

// Leaves the child to be waited for.
bool has_ended(pid_t pid) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid;
}

// kExited when the child ended by itself, otherwise why it has to be killed.
End wait_for_end(pid_t pid, double timeout_s, Clock::time_point start, const StopQuery& stop_requested) {
  const int descriptor = pidfd_open(pid, 0);  // -1, which poll() passes over: in a sandbox, or too many files
  const int poll_ms = descriptor < 0 ? kPollWithoutDescriptorMs : kPollMs;
  pollfd child{.fd = descriptor, .events = POLLIN, .revents = 0};
  End end = End::kExited;
  while (poll(&child, 1, poll_ms) <= 0 && !has_ended(pid)) {
    if (stop_requested && stop_requested()) end = End::kInterrupted;
    if (timeout_s > 0 && seconds_since(start) >= timeout_s) end = End::kTimedOut;
    if (end != End::kExited) break;
  }
  if (descriptor >= 0) close(descriptor);
  return end;
}

}  // namespace

ProcessOutcome run_process(const ProcessRequest& request, const StopQuery& stop_requested) {
  ProcessOutcome outcome;
  const auto start = Clock::now();
  pid_t pid = 0;
  if (const int error = SpawnSetup(request).spawn(request.arguments, pid); error != 0) {
    outcome.start_error = fmt::format("cannot start {}: {}", request.arguments.front(), std::strerror(error));
    return outcome;
  }
  outcome.end = wait_for_end(pid, request.timeout_s, start, stop_requested);
  if (outcome.end != End::kExited) kill(-pid, SIGKILL);
  int status = 0;
  rusage usage{};
  while (wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) continue;
  outcome.wall_s = seconds_since(start);
  outcome.user_s = seconds(usage.ru_utime);
  outcome.system_s = seconds(usage.ru_stime);
  // The maximum survives exec: it is at least this program's own, a few MiB.
  outcome.peak_rss_bytes = 1024 * static_cast<std::uint64_t>(usage.ru_maxrss);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  if (WIFSIGNALED(status) && outcome.end == End::kExited) outcome.end = End::kSignalled;
  return outcome;
}

std::string ProcessOutcome::describe() const {
  switch (end) {
    case End::kExited:
      return fmt::format("exit code {}", exit_code);
    case End::kSignalled:
      return fmt::format("killed by signal {} ({})", signal, strsignal(signal));
    case End::kTimedOut:
      return fmt::format("timed out, killed after {:.1f} s", wall_s);
    case End::kInterrupted:
      return "interrupted";
    case End::kNotStarted:
      break;
  }
  return start_error;
}

std::string read_tail(const std::string& path, std::size_t max_bytes) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return {};
  const auto size = static_cast<std::size_t>(file.tellg());
  file.seekg(static_cast<std::streamoff>(size - std::min(size, max_bytes)));
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace podm::bench
