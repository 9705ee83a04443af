#include "cli/stop_on_signal.h"

#include <atomic>

namespace podm::cli {
namespace {

// A handler may do little more than this: request_stop() takes locks.
std::atomic<bool> signal_noted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void note_signal(int) { signal_noted.store(true, std::memory_order_relaxed); }

}  // namespace

StopOnSignal::StopOnSignal() {
  signal_noted.store(false, std::memory_order_relaxed);
  struct sigaction note = {};
  note.sa_handler = note_signal;
  note.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &previous_[i]);
    if (previous_[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &note, nullptr);
  }
}

StopOnSignal::~StopOnSignal() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous_[i], nullptr);
}

void StopOnSignal::poll() {
  if (signal_noted.load(std::memory_order_relaxed)) source_.request_stop();
}

}  // namespace podm::cli
