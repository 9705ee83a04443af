// Any number of workers on one core, in virtual time: each attempt is carried out at once at its beginning,
// but its locks are held to its virtual end, so that workers conflict as they would on as many cores. Only
// the locks of an attempt that fails fall at once: its time is charged, but that attempts make each other
// fail for ever, as they may under Contention::kAggressive, does not show. The same seed gives the same run
// to the bit. For tests of interleavings, and for studies of machines that nobody has at hand; times are
// simulated, not measured.
//
// In a build with PODM_INTERLEAVING an attempt takes its virtual time in parts and holds its locks meanwhile:
// it stops at steps (delaunay/step.h), between which others go on.
#pragma once

#include <memory>
#include <optional>
#include <queue>
#include <random>
#include <span>
#include <vector>

#include "refine/attempt_call.h"
#include "refine/coordination.h"
#include "refine/executor.h"

namespace podm {

template <class Locks>
class VirtualExecutor {
 public:
  using Workers = std::span<const std::unique_ptr<Worker<Locks>>>;

  /// Groups of workers that coordinate among themselves only, `options` for each.
  VirtualExecutor(Watch& watch, const CoordinationOptions& options, VirtualCost cost, int num_groups = 1);

  /// Runs until every worker begs and no source, if there are any (one for each group), has more cells, or
  /// something ends the run.
  StopReason run(Workers workers, const std::vector<CellSource*>& sources = {});
  /// Virtual time that passed, s.
  double elapsed_s() const { return now_s_; }
  /// Of one worker, in virtual time.
  const Overhead& overhead(WorkerId worker) const { return desks_[worker].overhead; }

 private:
  struct Desk {
    AttemptCall call;
    std::optional<Outcome> in_progress;  // of the attempt that its next event ends
    double cost_s = 0;                   // of it
    double since_s = 0;                  // it waits or begs, or its attempt began
    bool begs = false;
    int conflicts = 0, successes = 0;  // in a row
    CellMeter meter;
    Overhead overhead;
  };
  struct Event {
    double time_s;
    std::uint64_t number;  // events of the same time come in the order they were made
    WorkerId worker;
    bool operator>(const Event& other) const {
      return time_s != other.time_s ? time_s > other.time_s : number > other.number;
    }
  };

  WorkerId group_of(WorkerId worker) const { return worker / group_size_; }
  WorkerId within_group(WorkerId worker) const { return worker % group_size_; }
  Coordination& coordination_of(WorkerId worker) { return *groups_[group_of(worker)]; }

  void schedule(WorkerId worker, double delay_s);
  void resume(WorkerId worker);
  bool step(Worker<Locks>& worker, WorkerId self);
  bool end_attempt(Worker<Locks>& worker, WorkerId self);
  void begin_attempt(Worker<Locks>& worker, WorkerId self);
  void go_on(WorkerId self);
  void stop(Workers workers);
  bool refill_idle_groups();
  std::optional<StopReason> reason_to_stop(Workers workers);

  Watch& watch_;
  VirtualCost cost_;
  WorkerId group_size_;
  std::mt19937_64 random_;
  std::vector<std::unique_ptr<Coordination>> groups_;
  std::vector<CellSource*> sources_;
  std::vector<Desk> desks_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t num_events_ = 0;
  double now_s_ = 0;
};

extern template class VirtualExecutor<VertexLocks>;
extern template class VirtualExecutor<LeafLocks<NoLocks>>;
extern template class VirtualExecutor<LeafLocks<VertexLocks>>;

}  // namespace podm
