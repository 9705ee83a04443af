// Contention managers: what a worker does when it finds a vertex locked by another. Try-locks exclude
// deadlock; these exclude livelock, two workers that roll each other back for ever. Foteinos, Chrisochoides,
// JPDC 74 (2014) 2123-2140, section 5:
//   aggressive  tries on at once; may livelock
//   random      after 5 conflicts in a row pauses for a random 1 to 5 ms; livelock is only unlikely
//   global      waits in one queue for all, whose head is woken by any worker after 10 successes in a row
//   local       waits in the queue of the worker it met, which wakes one after 10 successes in a row
// A manager only answers; time, real or virtual, blocks.
//
// Who waits, waits for one that runs. Local: a worker joins the queue of one that runs, and holds both their
// locks meanwhile, under which alone either begins to wait or to beg; so whoever would close a circle finds
// the other waiting, and each chain ends at one that runs. Who begs, first wakes its queue. Global: under the
// queue's lock, the last to run does not wait, and wakes all before it begs.
#pragma once

#include <atomic>
#include <deque>
#include <mutex>
#include <random>
#include <vector>

#include "podm/choices.h"
#include "runtime/worker_id.h"

namespace podm {

/// Any worker may make any call for itself at any time.
class ContentionManager {
 public:
  static constexpr int kConflictsToPause = 5;
  static constexpr int kSuccessesToWake = 10;

  struct Answer {
    enum Kind { kTryOn, kWait, kPause } kind = kTryOn;
    double pause_s = 0;
  };

  ContentionManager(Contention kind, int num_workers, std::uint64_t seed);

  /// `self` met a vertex of `holder` for the `in_a_row`-th time. After kWait it is in a queue until wake() or
  /// begin_to_beg() of another name it, maybe at once; then it runs.
  Answer conflict(WorkerId self, WorkerId holder, int in_a_row);
  /// Whom `self` wakes after kSuccessesToWake successes in a row; kNoWorker: nobody.
  WorkerId wake(WorkerId self);
  /// A hint: whether wake(self) would name somebody.
  bool may_wake(WorkerId self) const {
    return queue_of(self).num_waiting.load(std::memory_order_relaxed) > 0;
  }
  /// `self` stops running. Returns whom it wakes before: all that wait for it, and for global all when it is
  /// the last that runs.
  std::vector<WorkerId> begin_to_beg(WorkerId self);
  /// A worker that begged runs again.
  void run_again(WorkerId worker);

 private:
  // What belongs to one worker, guarded by the mutex; Contention::kGlobal uses the first alone.
  struct alignas(128) Queue {
    std::mutex mutex;
    std::deque<WorkerId> waiting;
    std::atomic<int> num_waiting = 0;
    bool owner_runs = true;

    void add(WorkerId worker);
    WorkerId take_first();
  };
  Queue& queue_of(WorkerId worker) { return queues_[kind_ == Contention::kGlobal ? 0 : worker]; }
  const Queue& queue_of(WorkerId worker) const { return queues_[kind_ == Contention::kGlobal ? 0 : worker]; }
  double random_pause_s();
  bool wait_for(WorkerId self, WorkerId holder);
  bool wait_for_any(WorkerId self);
  // The caller holds the lock of its queue.
  void stop_running(Queue& own);

  Contention kind_;
  std::vector<Queue> queues_;
  std::atomic<int> num_running_;  // Contention::kGlobal alone counts them
  std::mutex random_mutex_;
  std::mt19937_64 random_;
};

}  // namespace podm
