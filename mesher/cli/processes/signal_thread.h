// A thread that alone receives the signals that would end the program, at any moment: no worker has to look
// for them, and none ends the program with files half made.
#pragma once

#include <signal.h>

#include <atomic>
#include <stop_token>
#include <thread>

namespace podm::cli {

/// There is at most one, made before any other thread: these inherit that the signals are blocked. A signal
/// ends the program as it would without, but first removes the leftovers (files/leftovers.h). After
/// heed_first() the first SIGINT, SIGTERM or SIGHUP only requests a stop, and the next one ends. Signals that
/// were ignored, blocked or handled stay so, and crashes are left alone.
class SignalThread {
 public:
  SignalThread();
  /// The signals stay blocked: one that comes when all is done changes nothing.
  ~SignalThread();
  SignalThread(const SignalThread&) = delete;
  SignalThread& operator=(const SignalThread&) = delete;

  /// There is something worth keeping from now on. A quiet thread does not say that the signal has come. The
  /// first call counts.
  void heed_first(bool is_quiet);
  std::stop_token token() const { return source_.get_token(); }
  /// The mask that programs get which this one starts.
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
