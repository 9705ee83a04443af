// Workers on threads, one each. Workers that met another's lock wait as the contention manager says; workers
// without poor cells beg, and busy ones share the oldest cells of their lists. The run is complete when all
// beg.
//
// One mutex guards their coordination. It is taken on conflicts, when work runs out or is given, and after
// every 10 successes while somebody waits: not by operations that succeed alone.
#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "refine/coordination.h"
#include "refine/executor.h"
#include "runtime/placement.h"

namespace podm {

template <class Locks>
class ThreadExecutor {
 public:
  using Workers = std::span<const std::unique_ptr<Worker<Locks>>>;

  /// Binds the thread of worker i to the processor of places[i], if it has one. Workers have the ids from
  /// `first_id` on.
  ThreadExecutor(Watch& watch, const CoordinationOptions& options, std::vector<Place> places,
                 WorkerId first_id = 0);

  /// Runs until every worker begs and `source`, if any, has no more cells, or something ends the run, always
  /// between operations. Worker 0 runs on the calling thread; of all groups that which has the first worker
  /// observes. What a worker throws ends the run and is thrown again here, but for std::bad_alloc, which ends
  /// it as a limit does.
  StopReason run(Workers workers, CellSource* source = nullptr);
  /// Seconds of run() that went by before worker 0 began: threads were started for the others.
  double start_s() const { return start_s_; }
  /// What the system said of the worker's thread after it was bound.
  const ThreadProcessor& processor(WorkerId worker) const { return desks_[worker].processor; }
  const Overhead& overhead(WorkerId worker) const { return desks_[worker].overhead; }

 private:
  // What belongs to one worker, in cache lines of its own.
  struct alignas(128) Desk {
    std::condition_variable woken;
    CellMeter meter;
    Overhead overhead;
    ThreadProcessor processor;
  };

  void work(Worker<Locks>& worker, WorkerId self);
  void beg(Worker<Locks>& worker, WorkerId self);
  bool refill(WorkerId self);
  bool yield_after_conflict(WorkerId self, WorkerId holder, int in_a_row);
  void check(const Worker<Locks>& worker, WorkerId self);
  void end(StopReason reason, const std::exception_ptr& failure = nullptr);

  Watch& watch_;
  std::vector<Place> places_;
  WorkerId first_id_;
  std::mutex mutex_;
  Coordination coordination_;
  CellSource* source_ = nullptr;
  std::vector<Desk> desks_;
  std::atomic<bool> is_over_ = false;
  StopReason stop_reason_ = StopReason::kComplete;
  double start_s_ = 0;
  std::exception_ptr failure_;
};

extern template class ThreadExecutor<VertexLocks>;
extern template class ThreadExecutor<LeafLocks<NoLocks>>;
extern template class ThreadExecutor<LeafLocks<VertexLocks>>;

}  // namespace podm
