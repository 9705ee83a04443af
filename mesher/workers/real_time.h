// Workers on threads, one each, which block in real time.
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
  /// Binds the thread of worker i to the processor of places[i], if it has one; no places: to none.
  RealTime(StopControl& stop, std::size_t num_workers, std::vector<Place> places);

  /// Calls work(self) for each worker on a thread of its own, worker 0's on the calling one, and returns when
  /// all have returned; then it may be called again. What one throws ends the run and is thrown again here,
  /// but for std::bad_alloc, which ends it as a limit does.
  void run(const std::function<void(WorkerId)>& work);

  /// Makes an attempt, after which nothing is locked.
  template <class Worker>
  Outcome attempt(Worker& worker) {
    const Outcome outcome = worker.attempt();
    worker.release();
    // Who holds the vertices may want this processor. Without this `aggressive` hardly ends where threads
    // outnumber processors.
    if (outcome == Outcome::kLockConflict) std::this_thread::yield();
    if (++states_[worker.id()].attempts % StopControl::kAttemptsBetweenChecks == 0) check_limits(worker);
    return outcome;
  }
  /// Virtual time charges these; here they take what they take.
  static void spend(WorkerId, double) {}
  static void spend_in(const void*, WorkerId, double) {}
  static constexpr TimeCosts costs() { return {}; }
  /// Ends the run if a limit is passed, as is looked at now and then, and when a worker has nothing to do.
  template <class Worker>
  void check_limits(const Worker& worker) {
    states_[worker.id()].meter.report(worker, stop_);
    stop_.check_limits();
    if (worker.id() == 0) stop_.observe();
  }
  /// Waits until another resumes it, maybe before, or the run is over. The time is charged to `cause`.
  void block(WorkerId self, double Overhead::*cause);
  void resume(WorkerId worker) { states_[worker].resumed.release(); }
  void pause(WorkerId self, double seconds);
  bool is_over() const { return stop_.is_over(); }

  /// Seconds since this was made.
  double now_s() const { return seconds_since(start_); }
  /// Seconds of run() that went by before worker 0 began: threads were started for the others.
  double start_s() const { return start_s_; }
  /// What the system said of the worker's thread after it was bound.
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

  // What belongs to one worker, in cache lines of its own.
  struct alignas(128) WorkerState {
    std::counting_semaphore<> resumed{0};
    unsigned attempts = 0;
    CellMeter meter;
    Overhead overhead;
    ThreadProcessor processor;
  };

  void work_on_thread(const std::function<void(WorkerId)>& work, WorkerId self);
  void fail();

  StopControl& stop_;
  std::vector<Place> places_;
  std::vector<WorkerState> states_;
  Clock::time_point start_ = Clock::now();
  double start_s_ = 0;
  std::mutex mutex_;  // guards failure_
  std::exception_ptr failure_;
  std::stop_callback<std::function<void()>> on_over_;  // the last: it may be called before it is made
};

}  // namespace podm
