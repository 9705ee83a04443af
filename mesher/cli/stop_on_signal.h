// SIGINT and SIGTERM ask a run to stop instead of ending it.
#pragma once

#include <signal.h>

#include <array>
#include <stop_token>

namespace podm::cli {

/// At most one at a time. While it lives the first signal of each kind only leaves a note, which poll() turns
/// into a stop request; a second one has its usual effect. A signal that was ignored stays ignored.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  void poll();
  std::stop_token token() const { return source_.get_token(); }

 private:
  static constexpr std::array<int, 2> kSignals{SIGINT, SIGTERM};

  std::stop_source source_;
  std::array<struct sigaction, kSignals.size()> previous_;
};

}  // namespace podm::cli
