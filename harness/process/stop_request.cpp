#include "process/stop_request.h"

#include <atomic>
#include <csignal>

namespace podm::bench {
namespace {

std::atomic<bool> has_signal_come = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait");

void remember_signal(int) { has_signal_come = true; }

}  // namespace

StopQuery stop_on_signals() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, remember_signal);
  return [] { return has_signal_come.load(); };
}

}  // namespace podm::bench
