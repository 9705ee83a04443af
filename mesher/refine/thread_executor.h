// Workers on threads, one each. Workers that met another's lock wait as the contention manager says; workers
// without poor cells beg, and busy ones share the oldest cells of their lists. The run is complete when all
// beg.
//
// One mutex guards contention manager, begging list and activity. It is taken on conflicts, when work runs
// out or is given, and after every 10 successes while somebody waits: not by operations that succeed alone.
#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "refine/activity.h"
#include "refine/begging_list.h"
#include "refine/contention_manager.h"
#include "refine/executor.h"

namespace podm {

/// Seconds that one worker did no work, by cause.
struct Idleness {
  double contention_s = 0, begging_s = 0;
};

class ThreadExecutor {
 public:
  using Workers = std::vector<std::unique_ptr<Worker<VertexLocks>>>;

  ThreadExecutor(Watch& watch, int num_threads, Contention contention, std::uint64_t seed);

  /// Runs until every worker begs, or something ends the run, always between operations. Worker 0 runs on the
  /// calling thread, which alone observes. What a worker throws is thrown again here.
  StopReason run(Workers& workers, const Mesh& mesh);
  const Idleness& idleness(WorkerId worker) const { return desks_[worker].idleness; }

 private:
  // What belongs to one worker, in cache lines of its own.
  struct alignas(128) Desk {
    std::condition_variable woken;
    std::vector<PoorElementList::Entry> mail;
    std::atomic<std::int64_t> net_cells = 0;
    Idleness idleness;
  };

  void work(Worker<VertexLocks>& worker, WorkerId self, const Mesh& mesh);
  bool beg(Worker<VertexLocks>& worker, WorkerId self);
  void share(Worker<VertexLocks>& worker, WorkerId self);
  void yield_after_conflict(WorkerId self, WorkerId holder, int in_a_row);
  void wake_one(WorkerId self);
  void check(Worker<VertexLocks>& worker, WorkerId self, const Mesh& mesh);
  void set_running(WorkerId worker);
  void end(StopReason reason, const std::exception_ptr& failure);

  Watch& watch_;
  std::mutex mutex_;
  Activity activity_;
  ContentionManager contention_;
  BeggingList begging_;
  std::vector<Desk> desks_;
  std::atomic<bool> is_over_ = false;
  StopReason stop_reason_ = StopReason::kComplete;
  std::exception_ptr failure_;
};

}  // namespace podm
