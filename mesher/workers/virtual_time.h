// Any number of workers on one core, in virtual time: each works on a fibre, and an attempt is carried out at
// once at its beginning, but its locks are held to its virtual end, so that workers conflict as they would on
// as many cores. Only the locks of an attempt that fails fall at once: its time is charged, but that attempts
// make each other fail for ever, as they may under Contention::kAggressive, does not show. The same seed
// gives the same run to the bit. This serves tests of interleavings, and studies of machines that nobody has
// at hand; times are simulated, not measured.
//
// In a build with PODM_INTERLEAVING an attempt takes its virtual time in parts and holds its locks meanwhile:
// it stops at steps (delaunay/step.h), between which others go on.
#pragma once

#include <functional>
#include <memory>
#include <queue>
#include <random>
#include <vector>

#include "podm/counters.h"
#include "refine/outcome.h"
#include "runtime/fibre.h"
#include "runtime/worker_id.h"
#include "workers/stop_control.h"

namespace podm {

class VirtualTime {
 public:
  VirtualTime(StopControl& stop, std::size_t num_workers, VirtualCost cost, std::uint64_t seed);

  /// Calls work(self) for each worker, on a fibre of its own, and returns when all have returned; then it may
  /// be called again, and time goes on. What one throws ends the run and is thrown again here, but for
  /// std::bad_alloc, which ends it as a limit does.
  void run(const std::function<void(WorkerId)>& work);

  /// Makes an attempt, after whose virtual end nothing is locked.
  template <class Worker>
  Outcome attempt(Worker& worker) {
    const WorkerId self = worker.id();
    begin_attempt(self);
    const Work before = work_of(worker);
    const Outcome outcome = worker.attempt();
    states_[self].meter.report(worker, stop_);
    if (kIsInParts || outcome == Outcome::kLockConflict) worker.release();
    end_attempt(self, work_of(worker) - before, outcome);
    worker.release();
    return outcome;
  }
  /// Ends the run if a limit is passed; as in RealTime.
  template <class Worker>
  void check_limits(const Worker&) {
    stop_.check_limits();
  }
  /// Waits until another resumes it, or the run is over. The time is charged to `cause`.
  void block(WorkerId self, double Overhead::*cause);
  void resume(WorkerId worker) { schedule(worker, 0); }
  void pause(WorkerId self, double seconds);
  bool is_over() const { return stop_.is_over(); }

  /// Virtual time that passed.
  double now_s() const { return now_s_; }
  template <class Worker>
  const Overhead& overhead(const Worker& worker) const {
    return states_[worker.id()].overhead;
  }

 private:
#ifdef PODM_INTERLEAVING
  static constexpr bool kIsInParts = true;
#else
  static constexpr bool kIsInParts = false;
#endif

  // What attempts are charged for.
  struct Work {
    std::uint64_t classified, tests, created;
    Work operator-(const Work& b) const {
      return {classified - b.classified, tests - b.tests, created - b.created};
    }
  };
  template <class Worker>
  static Work work_of(const Worker& worker) {
    const Counters& counters = worker.counters();
    return {counters.classified_cells, counters.conflict_tests, counters.cells_created};
  }

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

  double seconds(const Work& work) const;
  void begin_attempt(WorkerId self);
  void end_attempt(WorkerId self, const Work& work, Outcome outcome);
  void allow_part(WorkerState& state);
  void schedule(WorkerId worker, double delay_s);
  void go_on(WorkerId worker);
  void finish_all();

  StopControl& stop_;
  VirtualCost cost_;
  std::mt19937_64 random_;
  std::vector<WorkerState> states_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t num_events_ = 0;
  double now_s_ = 0;
};

}  // namespace podm
