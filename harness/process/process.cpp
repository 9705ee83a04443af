#include "process/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
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
#include <list>
#include <new>
#include <sstream>

extern "C" {  // the header of glibc 2.36 has no C linkage
#include <sys/pidfd.h>
}

namespace podm::bench {
namespace {

using Clock = std::chrono::steady_clock;
using End = ProcessOutcome::End;

constexpr int kPollMs = 100;  // delay at most of a stop request or the time limit; an end is seen at once
constexpr int kPollMemoryMs = 20;            // a limit is exceeded by less than 0.1 GiB at a few GiB/s
constexpr int kPollWithoutDescriptorMs = 1;  // an end is then seen this late at most

constexpr double kBytesPerGib = 1024.0 * 1024 * 1024;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Replaces `descriptor` by the file, in the child and permanently. Returns false with errno.
bool redirect(int descriptor, const std::string& path, int flags) {
  close(descriptor);  // it may be the last descriptor available
  const int file = open(path.empty() ? "/dev/null" : path.c_str(), flags, 0666);
  if (file < 0 || file == descriptor) return file >= 0;
  return dup2(file, descriptor) >= 0 && close(file) == 0;
}

// Binds this process to the processor. Returns false with errno.
bool bind_to(int processor) {
  cpu_set_t processors;
  CPU_ZERO(&processors);
  CPU_SET(processor, &processors);
  return sched_setaffinity(0, sizeof(processors), &processors) == 0;
}

// Prepares the child and executes the program. Returns the error when that fails. The child leads a process
// group of its own: a kill then reaches its children too, and Ctrl-C at the terminal does not reach it.
int become(const ProcessRequest& request, char* const* arguments, pid_t parent) {
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent died before the line above
  if (request.processor && !bind_to(*request.processor)) return errno;
  if (redirect(STDIN_FILENO, "", O_RDONLY) && redirect(STDOUT_FILENO, request.stdout_path, kWrite) &&
      redirect(STDERR_FILENO, request.stderr_path, kWrite))
    execvp(arguments[0], arguments);
  return errno;
}

// A number that parent and child share: the error of a child that did not execute its program.
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

// Returns 0 when the size is not available.
std::uint64_t resident_bytes(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/statm", pid));
  std::uint64_t pages = 0, resident_pages = 0;
  file >> pages >> resident_pages;
  return resident_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

// A child process from its start until it has been waited for.
class Child {
 public:
  explicit Child(const ProcessRequest& request) : request_(request), start_(Clock::now()), pid_(start()) {
    if (pid_ < 0) error_.value() = errno;
    if (pid_ > 0) descriptor_ = pidfd_open(pid_, 0);  // -1 in a sandbox, or with too many files
  }
  ~Child() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  bool is_running() const { return is_running_; }
  int descriptor() const { return descriptor_; }
  int poll_ms() const {
    return descriptor_ < 0                   ? kPollWithoutDescriptorMs
           : request_.memory_limit_bytes > 0 ? kPollMemoryMs
                                             : kPollMs;
  }
  // Waits for the child when it has ended. Kills it at a limit or on request.
  void look(bool is_stop_requested) {
    if (has_ended()) return wait();
    if (is_stop_requested) outcome_.end = End::kInterrupted;
    if (request_.timeout_s > 0 && seconds_since(start_) >= request_.timeout_s) outcome_.end = End::kTimedOut;
    if (request_.memory_limit_bytes > 0 && resident_bytes(pid_) > request_.memory_limit_bytes)
      outcome_.end = End::kOutOfMemory;
    if (outcome_.end == End::kNotStarted) return;
    kill(-pid_, SIGKILL);
    wait();
  }
  const ProcessOutcome& outcome() const { return outcome_; }

 private:
  // Returns the child's id, or -1 with errno.
  pid_t start() {
    std::vector<std::string> arguments = request_.arguments;
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid == 0) {
      error_.value() = become(request_, pointers.data(), parent);
      _exit(1);
    }
    if (pid > 0) setpgid(pid, pid);  // parent and child both set it, as either may run first
    return pid;
  }

  // True if the child has ended or did not start. The child can still be waited for.
  bool has_ended() const {
    siginfo_t info{};
    return pid_ < 0 || (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
                        info.si_pid == pid_);
  }

  void wait() {
    is_running_ = false;
    int status = 0;
    rusage usage{};
    while (pid_ > 0 && wait4(pid_, &status, 0, &usage) < 0 && errno == EINTR) continue;
    if (error_.value() != 0) {
      outcome_.end = End::kNotStarted;
      outcome_.start_error =
          fmt::format("cannot start {}: {}", request_.arguments.front(), std::strerror(error_.value()));
      return;
    }
    outcome_.wall_s = seconds_since(start_);
    outcome_.user_s = seconds(usage.ru_utime);
    outcome_.system_s = seconds(usage.ru_stime);
    // The maximum survives exec. It is therefore at least this program's own, a few MiB.
    outcome_.peak_rss_bytes = 1024 * static_cast<std::uint64_t>(usage.ru_maxrss);
    outcome_.page_faults = static_cast<std::uint64_t>(usage.ru_minflt + usage.ru_majflt);
    outcome_.context_switches = static_cast<std::uint64_t>(usage.ru_nvcsw + usage.ru_nivcsw);
    if (WIFEXITED(status)) outcome_.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome_.signal = WTERMSIG(status);
    if (outcome_.end == End::kNotStarted) outcome_.end = WIFSIGNALED(status) ? End::kSignalled : End::kExited;
  }

  const ProcessRequest& request_;
  SharedError error_;
  Clock::time_point start_;
  pid_t pid_;
  int descriptor_ = -1;
  bool is_running_ = true;
  ProcessOutcome outcome_;  // `end` is kNotStarted until the child has ended
};

// Waits until a child ends or the next check is due.
void wait_for_news(const std::list<Child>& children) {
  std::vector<pollfd> running;
  int poll_ms = kPollMs;
  for (const Child& child : children) {
    if (!child.is_running()) continue;
    running.push_back({.fd = child.descriptor(), .events = POLLIN, .revents = 0});  // poll() ignores -1
    poll_ms = std::min(poll_ms, child.poll_ms());
  }
  poll(running.data(), running.size(), poll_ms);
}

}  // namespace

std::vector<ProcessOutcome> run_processes(const std::vector<ProcessRequest>& requests,
                                          const StopQuery& stop_requested) {
  std::list<Child> children;  // a Child cannot be moved
  for (const ProcessRequest& request : requests) children.emplace_back(request);
  const auto is_running = [](const Child& child) { return child.is_running(); };
  while (std::any_of(children.begin(), children.end(), is_running)) {
    wait_for_news(children);
    const bool is_stop_requested = stop_requested && stop_requested();
    for (Child& child : children)
      if (child.is_running()) child.look(is_stop_requested);
  }
  std::vector<ProcessOutcome> outcomes;
  for (const Child& child : children) outcomes.push_back(child.outcome());
  return outcomes;
}

ProcessOutcome run_process(const ProcessRequest& request, const StopQuery& stop_requested) {
  return run_processes({request}, stop_requested).front();
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
