// Contention managers: what a worker does when it finds a vertex locked by another. Try-locks exclude
// deadlock; these exclude livelock, two workers that roll each other back for ever. Foteinos, Chrisochoides,
// JPDC 74 (2014) 2123-2140, section 5:
//   aggressive  tries on at once; may livelock
//   random      after 5 conflicts in a row pauses for a random 1 to 5 ms; livelock is only unlikely
//   global      waits in one list for all, whose head is woken by any worker after 10 successes in a row
//   local       waits in the list of the worker it met, which wakes one after 10 successes in a row
// A manager only answers; executors block. Its caller makes sure that one call is made at a time.
#pragma once

#include <atomic>
#include <deque>
#include <random>
#include <string>
#include <vector>

#include "podm/choices.h"
#include "workers/activity.h"

namespace podm {

class ContentionManager {
 public:
  static constexpr int kConflictsToPause = 5;
  static constexpr int kSuccessesToWake = 10;

  struct Answer {
    enum Kind { kTryOn, kWait, kPause } kind = kTryOn;
    double pause_s = 0;
  };

  ContentionManager(Contention kind, int num_workers, std::uint64_t seed);

  /// `self` met a vertex of `holder` for the `in_a_row`-th time. After kWait it is listed until wake() or
  /// idle() name it. Never kWait for the last worker that runs; nor, for local, behind one that does not run,
  /// so that every chain of waiting workers ends at one that runs.
  Answer conflict(WorkerId self, WorkerId holder, int in_a_row, const Activity& activity);
  /// Whom `self` wakes after kSuccessesToWake successes in a row; kNoWorker: nobody.
  WorkerId wake(WorkerId self);
  /// Whom `self` wakes before it stops running: all that wait for it, and for global all when it is the last.
  std::vector<WorkerId> idle(WorkerId self, const Activity& activity);
  /// A hint that anyone may ask for at any time.
  bool has_waiting() const { return num_waiting_.load(std::memory_order_relaxed) > 0; }

 private:
  std::deque<WorkerId>& list_of(WorkerId worker) { return lists_[kind_ == Contention::kGlobal ? 0 : worker]; }

  Contention kind_;
  std::vector<std::deque<WorkerId>> lists_;
  std::atomic<int> num_waiting_ = 0;
  std::mt19937_64 random_;
};

}  // namespace podm
