// Workers on threads, one each. Workers that met another's lock wait as the contention manager says; workers
// without poor cells beg, and busy ones share the oldest cells of their lists. The run is complete when all
// beg.
//
// One mutex guards their coordination. It is taken on conflicts, when work runs
// out or is given, and after every 10 successes while somebody waits: not by operations that succeed alone.
#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "refine/coordination.h"
#include "refine/executor.h"
#include "runtime/placement.h"

namespace podm {

class ThreadExecutor {
 public:
  using Workers = std::vector<std::unique_ptr<Worker<VertexLocks>>>;

  /// Binds the thread of worker i to the processor of places[i], if it has one.
  ThreadExecutor(Watch& watch, const CoordinationOptions& options, std::vector<Place> places);

  /// Runs until every worker begs, or something ends the run, always between operations. Worker 0 runs on the
  /// calling thread, which alone observes. What a worker throws is thrown again here, but for std::bad_alloc,
  /// which ends the run as a limit does.
  StopReason run(Workers& workers);
  /// What the system said of the worker's thread after it was bound.
  const ThreadProcessor& processor(WorkerId worker) const { return desks_[worker].processor; }
  const Overhead& overhead(WorkerId worker) const { return desks_[worker].overhead; }

 private:
  // What belongs to one worker, in cache lines of its own.
  struct alignas(128) Desk {
    std::condition_variable woken;
    std::atomic<std::int64_t> net_cells = 0;
    Overhead overhead;
    ThreadProcessor processor;
  };

  void work(Worker<VertexLocks>& worker, WorkerId self);
  bool beg(Worker<VertexLocks>& worker, WorkerId self);
  void yield_after_conflict(WorkerId self, WorkerId holder, int in_a_row);
  void check(const Worker<VertexLocks>& worker, WorkerId self);
  void end(StopReason reason, const std::exception_ptr& failure = nullptr);

  Watch& watch_;
  std::vector<Place> places_;
  std::mutex mutex_;
  Coordination coordination_;
  std::vector<Desk> desks_;
  std::atomic<bool> is_over_ = false;
  StopReason stop_reason_ = StopReason::kComplete;
  std::exception_ptr failure_;
};

}  // namespace podm
