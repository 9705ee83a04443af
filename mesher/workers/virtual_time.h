// Any number of workers on one core, in virtual time. Each worker runs on a fibre. An attempt is executed at
// once when it begins, but its locks are held until its virtual end, so that workers conflict as they would
// on as many cores. A failed attempt holds its locks as long, except for the time in which a real attempt
// looks up its list before it takes any lock. Attempts may therefore make each other fail forever under
// Contention::kAggressive, as on threads, and more easily here, because real attempts take their locks one
// after the other. The same seed gives the same run to the bit. Virtual time serves tests of interleavings,
// and studies of machines that are not at hand. Times are simulated, not measured.
//
// A worker's time advances by what it does. Attempts are charged for their counted work and, on a described
// machine, for the memory of other nodes that they access (workers/remote_memory.h). Between attempts a
// worker is charged for its operations on objects that workers share. workers/accounting.h has the rules. No
// cost depends on the algorithm or on the number of workers.
//
// In a build with PODM_INTERLEAVING an attempt takes its virtual time in parts and holds its locks meanwhile:
// it stops at steps (delaunay/step.h), and other workers run in between.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <random>
#include <vector>

#include "podm/counters.h"
#include "refine/outcome.h"
#include "runtime/fibre.h"
#include "runtime/worker_id.h"
#include "workers/accounting.h"
#include "workers/remote_memory.h"
#include "workers/stop_control.h"

namespace podm {

/// The uses of the virtual seconds of all workers, except those lost to Overhead.
struct VirtualSpending {
  double work_s = 0;           ///< attempts, for their counted work
  double remote_memory_s = 0;  ///< attempts, for the way to the memory of other nodes
  double network_s = 0;        ///< attempts, waiting where the network is busy
  double between_s = 0;        ///< between attempts: lists, gifts, leaves; also shared lines and new memory
  double queueing_s = 0;       ///< waiting for sections that admit one worker at a time

  VirtualSpending& operator+=(const VirtualSpending& b);
};

class VirtualTime {
 public:
  /// On `machine`, if given, worker i is on node nodes[i]. The machine must outlive this object.
  VirtualTime(StopControl& stop, std::size_t num_workers, VirtualCost cost, std::uint64_t seed,
              const MachineModel* machine = nullptr, std::vector<NodeIndex> nodes = {});

  /// Calls work(self) for each worker on a fibre of its own, and returns when all calls have returned. It may
  /// then be called again, and time goes on. An exception of a worker ends the run and is rethrown here,
  /// except std::bad_alloc, which ends the run as a limit does.
  void run(const std::function<void(WorkerId)>& work);

  /// Makes an attempt and releases its locks at its virtual end.
  template <class Worker>
  Outcome attempt(Worker& worker) {
    const WorkerId self = worker.id();
    begin_attempt(self);
    const Work before = work_of(worker.counters());
    const SharedRequests asked_before = shared_requests_of(worker);
    const Outcome outcome = worker.attempt();
    const bool reports = reports_cells(self, worker.net_cells());
    states_[self].meter.report(worker, stop_);
    if (kIsInParts) worker.release();
    end_attempt(self, work_of(worker.counters()) - before, worker.accesses(), outcome,
                shared_use(asked_before, shared_requests_of(worker), reports));
    worker.release();
    if (outcome == Outcome::kLockConflict) pass_unlocked(self);
    return outcome;
  }
  /// The worker does something else, which takes `reference_s` seconds on the reference core. It holds no
  /// locks, and no other worker may be about to resume it.
  void spend(WorkerId self, double reference_s);
  /// Does the same in a section that admits one worker at a time, first come first served.
  void spend_in(const void* section, WorkerId self, double reference_s);
  /// Ends the run if a limit is exceeded, as in RealTime.
  template <class Worker>
  void check_limits(const Worker&) {
    stop_.check_limits();
  }
  /// Waits until another worker resumes `self`, or until the run is over. The time is charged to `cause`.
  void block(WorkerId self, double Overhead::*cause);
  void resume(WorkerId worker) { schedule(worker, wake_s_); }
  void pause(WorkerId self, double seconds);
  bool is_over() const { return stop_.is_over(); }

  /// Virtual seconds that have passed.
  double now_s() const { return now_s_; }
  template <class Worker>
  const Overhead& overhead(const Worker& worker) const {
    return states_[worker.id()].overhead;
  }
  const VirtualSpending& spending() const { return spending_; }
  /// Virtual seconds in which the processors of all workers were busy.
  double busy_s() const;
  /// Processor seconds that run() took.
  double processor_s() const { return processor_s_; }
  /// The costs that accounted operations spend.
  const TimeCosts& costs() const { return costs_; }

 private:
#ifdef PODM_INTERLEAVING
  static constexpr bool kIsInParts = true;
#else
  static constexpr bool kIsInParts = false;
#endif

  struct WorkerState {
    std::unique_ptr<Fibre> fibre;
    double since_s = 0;            // the beginning of its attempt
    std::uint64_t most_steps = 0;  // of one part of its attempt, at most; 0 outside of attempts
    CellMeter meter;
    std::uint64_t num_attempts = 0;
    std::int64_t reported_cells = 0;  // as a real worker reports them
    Overhead overhead;
  };
  struct Section {
    double free_at_s = 0;       // the time when the last worker leaves it
    WorkerId last = kNoWorker;  // to enter it
  };
  struct Event {
    double time_s;
    std::uint64_t number;  // events of the same time come in the order of their creation
    WorkerId worker;
    bool operator>(const Event& other) const {
      return time_s != other.time_s ? time_s > other.time_s : number > other.number;
    }
  };

  double reference_seconds(const Work& work) const;
  void begin_attempt(WorkerId self);
  void end_attempt(WorkerId self, const Work& work, const std::optional<AccessTally>& accesses,
                   Outcome outcome, const SharedUse& use);
  bool reports_cells(WorkerId self, std::int64_t net_cells);
  double enter(Section& section, WorkerId self, double after_s, double inside_s);
  double sharing_seconds(WorkerId self, const SharedUse& use, Outcome outcome);
  void pass_unlocked(WorkerId self);
  double unlocked_seconds() const;
  void pass(WorkerId self, double seconds);
  void allow_part(WorkerState& state);
  void schedule(WorkerId worker, double delay_s);
  void advance(WorkerId worker);
  void finish_all();

  StopControl& stop_;
  VirtualCost cost_;
  TimeCosts costs_;
  double speed_ = 1, wake_s_ = 0, lock_s_ = 0, line_transfer_s_ = 0, page_fault_s_ = 0;  // of the machine
  std::optional<RemoteMemory> remote_;  // of a machine of several nodes
  std::map<const void*, Section> sections_;
  Section ids_, memory_map_, num_cells_;  // shared during attempts
  VirtualSpending spending_;
  std::mt19937_64 random_;
  std::vector<WorkerState> states_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t num_events_ = 0;
  double now_s_ = 0, processor_s_ = 0;
};

}  // namespace podm
