#include "cli/signal_thread.h"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <string>

#include "files/leftovers.h"

namespace podm::cli {
namespace {

struct AwaitedSignal {
  int number;
  const char* name;
  bool may_stop;  // else it ends the program whenever it comes
};

// All that end a program and that people and batch systems send. SIGXCPU comes every second.
constexpr std::array<AwaitedSignal, 7> kAwaited{{{SIGINT, "SIGINT", true},
                                                 {SIGTERM, "SIGTERM", true},
                                                 {SIGHUP, "SIGHUP", true},
                                                 {SIGQUIT, "SIGQUIT", false},
                                                 {SIGXCPU, "SIGXCPU", false},
                                                 {SIGUSR1, "SIGUSR1", false},
                                                 {SIGUSR2, "SIGUSR2", false}}};

const AwaitedSignal& awaited(int number) {
  std::size_t i = 0;
  while (kAwaited[i].number != number) ++i;
  return kAwaited[i];
}

[[noreturn]] void end_by(int number) {
  remove_leftovers_for_good();
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  raise(number);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  _exit(128 + number);  // the first process of a container outlives its own signals
}

// Not by way of stdio, whose lock a thread may hold that waits for the reader of a full pipe; nor does this.
void tell(const AwaitedSignal& signal) {
  const std::string text = std::string(isatty(STDERR_FILENO) != 0 ? "\n" : "") + "podm: " + signal.name +
                           ": the run ends early, with what there is; another signal ends it at once\n";
  pollfd errors{STDERR_FILENO, POLLOUT, 0};
  if (poll(&errors, 1, 0) != 1 || (errors.revents & POLLOUT) == 0) return;
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) return;  // nobody reads it
}

}  // namespace

SignalThread::SignalThread() {
  pthread_sigmask(SIG_SETMASK, nullptr, &mask_before_);
  sigemptyset(&awaited_);
  for (const AwaitedSignal& signal : kAwaited) {
    struct sigaction action;
    sigaction(signal.number, nullptr, &action);
    if (action.sa_handler == SIG_IGN || sigismember(&mask_before_, signal.number) == 1) continue;
    sigaddset(&awaited_, signal.number);
    any_awaited_ = signal.number;
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

void SignalThread::heed_first(bool is_quiet) {
  if (first_ != First::kEnds) return;
  is_quiet_ = is_quiet;
  first_ = First::kStops;
}

void SignalThread::receive() {
  for (;;) {
    int number = 0;
    if (sigwait(&awaited_, &number) != 0) continue;
    if (is_done_) return;
    const AwaitedSignal& signal = awaited(number);
    First stops = First::kStops;
    if (!signal.may_stop || !first_.compare_exchange_strong(stops, First::kHasStopped)) end_by(number);
    source_.request_stop();
    if (!is_quiet_) tell(signal);
  }
}

}  // namespace podm::cli
