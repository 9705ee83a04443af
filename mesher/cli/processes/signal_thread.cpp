#include "cli/processes/signal_thread.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>

#include "files/leftovers.h"

namespace podm::cli {
namespace {

struct StoppingSignal {
  int number;
  const char* name;
};

constexpr std::array<StoppingSignal, 3> kStopping{
    {{SIGINT, "SIGINT"}, {SIGTERM, "SIGTERM"}, {SIGHUP, "SIGHUP"}}};

// Returns null for a signal that always ends the program.
const StoppingSignal* stopping(int number) {
  for (const StoppingSignal& signal : kStopping)
    if (signal.number == number) return &signal;
  return nullptr;
}

// Signals that end no program by default, report a crash, or cannot be received.
constexpr std::array kLeftAlone{SIGCHLD, SIGCONT, SIGTSTP, SIGTTIN, SIGTTOU, SIGURG,  SIGWINCH, SIGABRT,
                                SIGBUS,  SIGFPE,  SIGILL,  SIGSEGV, SIGSYS,  SIGTRAP, SIGKILL,  SIGSTOP};

// Returns true for signals that would end the program: neither ignored, nor blocked, nor handled by code that
// was loaded before.
bool is_awaited(int number, const sigset_t& blocked) {
  struct sigaction action;
  return std::find(kLeftAlone.begin(), kLeftAlone.end(), number) == kLeftAlone.end() &&
         sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_DFL &&
         sigismember(&blocked, number) == 0;
}

[[noreturn]] void end_by(int number) {
  remove_leftovers_for_good();
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  raise(number);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  _exit(128 + number);  // the first process of a container survives its own signals
}

// Does not use stdio, because a thread that waits for the reader of a full pipe may hold its lock. Never
// waits itself.
void report(const StoppingSignal& signal) {
  const std::string text = std::string(isatty(STDERR_FILENO) != 0 ? "\n" : "") + "podm: " + signal.name +
                           ": the run ends early with a partial result; another signal ends it at once\n";
  pollfd errors{STDERR_FILENO, POLLOUT, 0};
  if (poll(&errors, 1, 0) != 1 || (errors.revents & POLLOUT) == 0) return;
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) return;  // there is no reader
}

}  // namespace

SignalThread::SignalThread() {
  pthread_sigmask(SIG_SETMASK, nullptr, &mask_before_);
  sigemptyset(&awaited_);
  for (int number = 1; number <= SIGRTMAX; ++number) {
    if (!is_awaited(number, mask_before_)) continue;
    sigaddset(&awaited_, number);
    // The first is no real-time signal. Those may be lost: by qemu, or where the user's queue is full.
    if (any_awaited_ == 0) any_awaited_ = number;
  }
  if (any_awaited_ == 0) return;
  pthread_sigmask(SIG_BLOCK, &awaited_, nullptr);
  thread_ = std::thread([this] { receive(); });
}

SignalThread::~SignalThread() {
  if (!thread_.joinable()) return;
  is_done_ = true;
  pthread_kill(thread_.native_handle(), any_awaited_);
  thread_.join();
}

void SignalThread::stop_on_first_signal(bool is_quiet) {
  if (first_ != First::kEnds) return;
  is_quiet_ = is_quiet;
  first_ = First::kStops;
}

void SignalThread::receive() {
  for (;;) {
    int number = 0;
    if (sigwait(&awaited_, &number) != 0) continue;
    if (is_done_) return;
    const StoppingSignal* signal = stopping(number);
    First stops = First::kStops;
    if (signal == nullptr || !first_.compare_exchange_strong(stops, First::kHasStopped)) end_by(number);
    source_.request_stop();
    if (!is_quiet_) report(*signal);
  }
}

}  // namespace podm::cli
