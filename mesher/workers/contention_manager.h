// Contention managers: they decide what a worker does when it finds a vertex locked by another worker.
// Try-locks exclude deadlock. Contention managers exclude livelock, in which two workers roll each other back
// forever. Foteinos, Chrisochoides, JPDC 74 (2014) 2123-2140, section 5:
//   aggressive  tries again at once; may livelock
//   random      after 5 conflicts in a row pauses for a random 1 to 5 ms; livelock is only unlikely
//   global      waits in one queue for all, whose head is woken by any worker after 10 successes in a row
//   local       waits in the queue of the worker it met, which wakes one after 10 successes in a row
// A manager only answers; time, real or virtual, does the blocking.
//
// Each worker that waits, waits for one that runs. Local: a worker joins the queue of a running worker and
// holds the locks of both queues meanwhile. A worker begins to wait or to beg only under the lock of its own
// queue. A worker that would close a cycle therefore finds the other one waiting, and each chain ends at a
// running worker. A worker that begins to beg first wakes its queue. Global: under the queue's lock, the last
// running worker does not wait, and it wakes all waiting workers before it begs.
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

  /// `self` met a vertex of `holder` for the `in_a_row`-th time. After kWait `self` is in a queue until
  /// wake() or begin_to_beg() of another worker returns it, possibly at once. Then it runs.
  Answer conflict(WorkerId self, WorkerId holder, int in_a_row);
  /// Returns the worker that `self` wakes after kSuccessesToWake successes in a row, or kNoWorker.
  WorkerId wake(WorkerId self);
  /// A hint: true if wake(self) would return a worker.
  bool may_wake(WorkerId self) const {
    return queue_of(self).num_waiting.load(std::memory_order_relaxed) > 0;
  }
  /// `self` stops running. Returns the workers that it wakes before: all that wait for it, and with kGlobal
  /// all waiting workers if it is the last one that runs.
  std::vector<WorkerId> begin_to_beg(WorkerId self);
  /// A worker that begged runs again.
  void run_again(WorkerId worker);

 private:
  // Data of one worker, guarded by the mutex. Contention::kGlobal uses only the first queue.
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
  // The caller holds the lock of the worker's queue.
  void stop_running(Queue& own);

  Contention kind_;
  std::vector<Queue> queues_;
  std::atomic<int> num_running_;  // counted with Contention::kGlobal only
  std::mutex random_mutex_;
  std::mt19937_64 random_;
};

}  // namespace podm
