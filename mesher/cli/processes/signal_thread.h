// A thread that receives all signals that would end the program, at any moment. Workers need not check for
// signals, and no signal ends the program while it leaves incomplete files.
#pragma once

#include <signal.h>

#include <atomic>
#include <stop_token>
#include <thread>

namespace podm::cli {

/// At most one object exists, made before any other thread: later threads inherit the blocked signals. A
/// signal ends the program as it would without this thread, but the thread first removes the leftovers
/// (files/leftovers.h). After stop_on_first_signal() the first SIGINT, SIGTERM or SIGHUP only requests a
/// stop, and the next one ends the program. Signals that were ignored, blocked or handled stay so. Crashes
/// are not affected.
class SignalThread {
 public:
  SignalThread();
  /// The signals stay blocked: a signal after the end of the work has no effect.
  ~SignalThread();
  SignalThread(const SignalThread&) = delete;
  SignalThread& operator=(const SignalThread&) = delete;

  /// Declares that from now on there is a result to keep. A quiet thread does not report the signal. Only the
  /// first call has an effect.
  void stop_on_first_signal(bool is_quiet);
  std::stop_token token() const { return source_.get_token(); }
  /// Returns the signal mask for programs that this program starts.
  const sigset_t& mask_before() const { return mask_before_; }

 private:
  enum class First { kEnds, kStops, kHasStopped };

  void receive();

  sigset_t mask_before_, awaited_;
  int any_awaited_ = 0;  // 0: none
  std::stop_source source_;
  std::atomic<First> first_ = First::kEnds;
  std::atomic<bool> is_quiet_ = false, is_done_ = false;
  std::thread thread_;
};

}  // namespace podm::cli
