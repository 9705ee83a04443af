// Workers that run on one thread each and block in real time.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <mutex>
#include <semaphore>
#include <thread>
#include <vector>

#include "podm/counters.h"
#include "refine/outcome.h"
#include "runtime/placement.h"
#include "runtime/time_costs.h"
#include "runtime/worker_id.h"
#include "workers/stop_control.h"

namespace podm {

class RealTime {
 public:
  /// Binds the thread of worker i to the processor of places[i], if it has one. Binds no thread if `places`
  /// is empty.
  RealTime(StopControl& stop, std::size_t num_workers, std::vector<Place> places);

  /// Calls work(self) for each worker on a thread of its own, for worker 0 on the calling thread, and returns
  /// when all calls have returned. It may then be called again. An exception of a worker ends the run and is
  /// rethrown here, except std::bad_alloc, which ends the run as a limit does.
  void run(const std::function<void(WorkerId)>& work);

  /// Makes an attempt and releases its locks.
  template <class Worker>
  Outcome attempt(Worker& worker) {
    const Outcome outcome = worker.attempt();
    worker.release();
    // The worker that holds the vertices may need this processor. Without the yield `aggressive` hardly
    // terminates where threads outnumber processors.
    if (outcome == Outcome::kLockConflict) std::this_thread::yield();
    if (++states_[worker.id()].attempts % StopControl::kAttemptsBetweenChecks == 0) {
      states_[worker.id()].meter.report_if_due(worker, states_.size(), stop_);
      check_and_observe(worker.id());
    }
    return outcome;
  }
  /// Accounted operations (workers/accounting.h) cost nothing here: they take the time that they take.
  static void spend(WorkerId, double) {}
  static void spend_in(const void*, WorkerId, double) {}
  static constexpr TimeCosts costs() { return {}; }
  /// Reports all cells of a worker whose work is over, and ends the run if a limit is exceeded.
  template <class Worker>
  void check_limits(const Worker& worker) {
    states_[worker.id()].meter.report(worker, stop_);
    check_and_observe(worker.id());
  }
  /// Waits until another worker resumes `self`, which may have happened before, or until the run is over. The
  /// time is charged to `cause`.
  void block(WorkerId self, double Overhead::*cause);
  void resume(WorkerId worker) { states_[worker].resumed.release(); }
  void pause(WorkerId self, double seconds);
  bool is_over() const { return stop_.is_over(); }

  /// Seconds since construction.
  double now_s() const { return seconds_since(start_); }
  /// Seconds of run() before worker 0 began, in which the threads of the other workers were started.
  double start_s() const { return start_s_; }
  /// Where the worker's thread ran after it was bound, as reported by the system.
  const ThreadProcessor& processor(WorkerId worker) const { return states_[worker].processor; }
  template <class Worker>
  Overhead overhead(const Worker& worker) const {
    Overhead overhead = states_[worker.id()].overhead;
    overhead.rollback_s = worker.counters().overhead.rollback_s;
    return overhead;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  // Data of one worker, in cache lines of its own.
  struct alignas(128) WorkerState {
    std::counting_semaphore<> resumed{0};
    unsigned attempts = 0;
    CellMeter meter;
    Overhead overhead;
    ThreadProcessor processor;
  };

  void check_and_observe(WorkerId self) {
    stop_.check_limits();
    if (self == 0) stop_.observe();
  }
  void work_on_thread(const std::function<void(WorkerId)>& work, WorkerId self);
  void fail();

  StopControl& stop_;
  std::vector<Place> places_;
  std::vector<WorkerState> states_;
  Clock::time_point start_ = Clock::now();
  double start_s_ = 0;
  std::mutex mutex_;  // guards failure_
  std::exception_ptr failure_;
  std::stop_callback<std::function<void()>> on_over_;  // last: it may be called while it is constructed
};

}  // namespace podm
