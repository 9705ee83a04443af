#include "process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <new>
#include <sstream>

extern "C" {  // missing in the header of glibc 2.36
#include <sys/pidfd.h>
}

namespace podm::bench {
namespace {

using Clock = std::chrono::steady_clock;
using End = ProcessOutcome::End;

constexpr int kPollMs = 100;  // how late a stop request or the time limit may be seen; an end is seen at once
constexpr int kPollMemoryMs = 20;            // at a few GiB/s, a limit is passed by less than 0.1 GiB
constexpr int kPollWithoutDescriptorMs = 1;  // an end is then seen this late

constexpr double kBytesPerGib = 1024.0 * 1024 * 1024;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// In the child, for good: the file in place of `descriptor`. False with errno.
bool redirect(int descriptor, const std::string& path, int flags) {
  close(descriptor);  // it may be the last that is to be had
  const int file = open(path.empty() ? "/dev/null" : path.c_str(), flags, 0666);
  if (file < 0 || file == descriptor) return file >= 0;
  return dup2(file, descriptor) >= 0 && close(file) == 0;
}

// What the child does until it is the program; returns the error when it does not become it. It leads a group
// of its own: a kill reaches its children too, a Ctrl-C at the terminal does not.
int become(const ProcessRequest& request, char* const* arguments, pid_t parent) {
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it died before the line above
  if (redirect(STDIN_FILENO, "", O_RDONLY) && redirect(STDOUT_FILENO, request.stdout_path, kWrite) &&
      redirect(STDERR_FILENO, request.stderr_path, kWrite))
    execvp(arguments[0], arguments);
  return errno;
}

// One number that parent and child see: the error of a child that did not become its program.
class SharedError {
 public:
  SharedError()
      : memory_(mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
  }
  ~SharedError() { munmap(memory_, sizeof(int)); }
  SharedError(const SharedError&) = delete;
  SharedError& operator=(const SharedError&) = delete;
  volatile int& value() { return *static_cast<volatile int*>(memory_); }

 private:
  void* memory_;
};

// The child's id, or -1 with errno.
pid_t start(const ProcessRequest& request, SharedError& error) {
  std::vector<std::string> arguments = request.arguments;
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    error.value() = become(request, pointers.data(), parent);
    _exit(1);
  }
  if (pid > 0) setpgid(pid, pid);  // whichever of the two comes first
  return pid;
}

// 0 when it cannot be known.
std::uint64_t resident_bytes(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/statm", pid));
  std::uint64_t pages = 0, resident_pages = 0;
  file >> pages >> resident_pages;
  return resident_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

// Leaves the child to be waited for.
bool has_ended(pid_t pid) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid;
}

// kExited when the child ended by itself, otherwise why it has to be killed.
End wait_for_end(pid_t pid, const ProcessRequest& request, Clock::time_point start,
                 const StopQuery& stop_requested) {
  const int descriptor = pidfd_open(pid, 0);  // -1, which poll() passes over: in a sandbox, or too many files
  const int poll_ms = descriptor < 0                   ? kPollWithoutDescriptorMs
                      : request.memory_limit_bytes > 0 ? kPollMemoryMs
                                                       : kPollMs;
  pollfd child{.fd = descriptor, .events = POLLIN, .revents = 0};
  End end = End::kExited;
  while (poll(&child, 1, poll_ms) <= 0 && !has_ended(pid)) {
    if (stop_requested && stop_requested()) end = End::kInterrupted;
    if (request.timeout_s > 0 && seconds_since(start) >= request.timeout_s) end = End::kTimedOut;
    if (request.memory_limit_bytes > 0 && resident_bytes(pid) > request.memory_limit_bytes)
      end = End::kOutOfMemory;
    if (end != End::kExited) break;
  }
  if (descriptor >= 0) close(descriptor);
  return end;
}

}  // namespace

ProcessOutcome run_process(const ProcessRequest& request, const StopQuery& stop_requested) {
  ProcessOutcome outcome;
  SharedError error;
  const auto start_time = Clock::now();
  const pid_t pid = start(request, error);
  if (pid < 0) error.value() = errno;
  if (pid > 0) outcome.end = wait_for_end(pid, request, start_time, stop_requested);
  if (pid > 0 && outcome.end != End::kExited) kill(-pid, SIGKILL);
  int status = 0;
  rusage usage{};
  while (pid > 0 && wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) continue;
  if (error.value() != 0) {
    outcome.end = End::kNotStarted;
    outcome.start_error =
        fmt::format("cannot start {}: {}", request.arguments.front(), std::strerror(error.value()));
    return outcome;
  }
  outcome.wall_s = seconds_since(start_time);
  outcome.user_s = seconds(usage.ru_utime);
  outcome.system_s = seconds(usage.ru_stime);
  // The maximum survives exec: it is at least this program's own, a few MiB.
  outcome.peak_rss_bytes = 1024 * static_cast<std::uint64_t>(usage.ru_maxrss);
  outcome.page_faults = static_cast<std::uint64_t>(usage.ru_minflt + usage.ru_majflt);
  outcome.context_switches = static_cast<std::uint64_t>(usage.ru_nvcsw + usage.ru_nivcsw);
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
    case End::kOutOfMemory:
      return fmt::format("above its memory limit, killed at {:.2f} GiB",
                         static_cast<double>(peak_rss_bytes) / kBytesPerGib);
    case End::kInterrupted:
      return "interrupted";
    case End::kNotStarted:
      break;
  }
  return start_error;
}

bool is_installed(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  return false;
}

std::string read_tail(const std::string& path, std::size_t max_bytes) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return {};
  const auto size = static_cast<std::size_t>(file.tellg());
  file.seekg(static_cast<std::streamoff>(size - std::min(size, max_bytes)));
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace podm::bench
