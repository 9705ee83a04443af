// Any number of workers on one core, in virtual time: each works on a fibre, and an attempt is carried out at
// once at its beginning, but its locks are held to its virtual end, so that workers conflict as they would on
// as many cores. An attempt that fails holds its locks as long, but for the while in which a real one looks
// up its list before it takes any. So attempts may make each other fail for ever under
// Contention::kAggressive, as they may on threads; more easily here, as real attempts take their locks one
// after the other. The same seed gives the same run to the bit. This serves tests of interleavings, and
// studies of machines that nobody has at hand; times are simulated, not measured.
//
// A worker's time goes on by what it does: attempts by their counted work (workers/work_cost.h) and, on a
// described machine, by the memory of other nodes that they touch (workers/remote_memory.h); what it does
// between attempts by what the algorithm says that it spends. No cost knows the algorithm or how many workers
// there are.
//
// In a build with PODM_INTERLEAVING an attempt takes its virtual time in parts and holds its locks meanwhile:
// it stops at steps (delaunay/step.h), between which others go on.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <queue>
#include <random>
#include <vector>

#include "podm/counters.h"
#include "refine/outcome.h"
#include "runtime/fibre.h"
#include "runtime/worker_id.h"
#include "workers/remote_memory.h"
#include "workers/stop_control.h"
#include "workers/work_cost.h"

namespace podm {

/// What the virtual seconds of all workers went into, those lost to Overhead apart.
struct VirtualSpending {
  double work_s = 0;           ///< attempts, by their counted work
  double remote_memory_s = 0;  ///< attempts, for the way to other nodes' memory
  double network_s = 0;        ///< attempts, waiting where the network is busy
  double between_s = 0;        ///< what lies between attempts: lists, gifts, leaves
  double queueing_s = 0;       ///< waiting for what one worker has at a time

  VirtualSpending& operator+=(const VirtualSpending& b);
};

class VirtualTime {
 public:
  /// `machine`, if given, is where the workers stand: worker i on node nodes[i]. It must outlive this.
  VirtualTime(StopControl& stop, std::size_t num_workers, VirtualCost cost, std::uint64_t seed,
              const MachineModel* machine = nullptr, std::vector<NodeIndex> nodes = {});

  /// Calls work(self) for each worker, on a fibre of its own, and returns when all have returned; then it may
  /// be called again, and time goes on. What one throws ends the run and is thrown again here, but for
  /// std::bad_alloc, which ends it as a limit does.
  void run(const std::function<void(WorkerId)>& work);

  /// Makes an attempt, after whose virtual end nothing is locked.
  template <class Worker>
  Outcome attempt(Worker& worker) {
    const WorkerId self = worker.id();
    begin_attempt(self);
    const Work before = work_of(worker.counters());
    const Outcome outcome = worker.attempt();
    states_[self].meter.report(worker, stop_);
    if (kIsInParts) worker.release();
    end_attempt(self, work_of(worker.counters()) - before, worker.accesses(), outcome);
    worker.release();
    if (outcome == Outcome::kLockConflict) pass_unlocked(self);
    return outcome;
  }
  /// The worker does something else, which takes so long on the reference core. It holds no locks, and no
  /// other may be about to resume it.
  void spend(WorkerId self, double reference_s);
  /// The same, in a section that one worker at a time is in, the first to come first.
  void spend_in(const void* section, WorkerId self, double reference_s);
  /// Ends the run if a limit is passed; as in RealTime.
  template <class Worker>
  void check_limits(const Worker&) {
    stop_.check_limits();
  }
  /// Waits until another resumes it, or the run is over. The time is charged to `cause`.
  void block(WorkerId self, double Overhead::*cause);
  void resume(WorkerId worker) { schedule(worker, wake_s_); }
  void pause(WorkerId self, double seconds);
  bool is_over() const { return stop_.is_over(); }

  /// Virtual time that passed.
  double now_s() const { return now_s_; }
  template <class Worker>
  const Overhead& overhead(const Worker& worker) const {
    return states_[worker.id()].overhead;
  }
  const VirtualSpending& spending() const { return spending_; }
  /// What one may spend.
  const TimeCosts& costs() const { return costs_; }

 private:
#ifdef PODM_INTERLEAVING
  static constexpr bool kIsInParts = true;
#else
  static constexpr bool kIsInParts = false;
#endif

  struct WorkerState {
    std::unique_ptr<Fibre> fibre;
    double since_s = 0;            // its attempt began
    std::uint64_t most_steps = 0;  // a part of it takes at most so many
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

  double reference_seconds(const Work& work) const;
  void begin_attempt(WorkerId self);
  void end_attempt(WorkerId self, const Work& work, const std::optional<AccessTally>& accesses,
                   Outcome outcome);
  void pass_unlocked(WorkerId self);
  double unlocked_seconds() const;
  void pass(WorkerId self, double seconds);
  void allow_part(WorkerState& state);
  void schedule(WorkerId worker, double delay_s);
  void go_on(WorkerId worker);
  void finish_all();

  StopControl& stop_;
  VirtualCost cost_;
  TimeCosts costs_;
  double speed_ = 1, wake_s_ = 0, lock_s_ = 0;  // of the machine's cores and system
  std::optional<RemoteMemory> remote_;          // of a machine of several nodes
  std::map<const void*, double> free_at_;       // when a section's last worker leaves it
  VirtualSpending spending_;
  std::mt19937_64 random_;
  std::vector<WorkerState> states_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t num_events_ = 0;
  double now_s_ = 0;
};

}  // namespace podm
