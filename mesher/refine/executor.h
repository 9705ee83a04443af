// What executors have in common: they run workers until no poor cell is left or something ends the run early.
// They alone know of time, limits, threads and waiting. This file's runs a single worker on the calling
// thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

#include "podm/mesh_image.h"
#include "refine/worker.h"

namespace podm {

/// Ends of a run that are not completion, but for memory, whose lack shows itself. 0: none.
struct Limits {
  std::uint64_t max_cells = 0;  // of the store
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

/// Looks at a run from outside, between operations. Executors that run at the same time or one after the
/// other share one, and all end when it says so. Any thread may call, but for observe().
class Watch {
 public:
  static constexpr int kAttemptsBetweenChecks = 1 << 8;  // of each worker, well below a millisecond

  /// `observe(cells)` is called a few times a second. Whoever requests the stop ends the run, so that over()
  /// tells of it even while nobody asks for reasons.
  Watch(const Limits& limits, std::stop_token stop, std::function<void(std::uint64_t)> observe)
      : limits_(limits),
        observe_(std::move(observe)),
        on_stop_(std::move(stop), [this] { end(StopReason::kCancelled); }) {}

  /// The store has so many more cells.
  void add_cells(std::int64_t more) { num_cells_.fetch_add(more, std::memory_order_relaxed); }
  /// Why the run has to end; nothing if it has not.
  std::optional<StopReason> reason_to_stop();
  /// kComplete as long as nothing has ended it.
  StopReason reason() const { return reason_; }
  /// Ends the run. The first reason counts.
  void end(StopReason reason);
  /// Requested when the run has to end.
  std::stop_token over() const { return over_.get_token(); }
  /// The thread that the run was called from calls.
  void observe();

 private:
  Limits limits_;
  std::function<void(std::uint64_t)> observe_;
  std::atomic<std::int64_t> num_cells_ = 0;
  std::atomic<StopReason> reason_ = StopReason::kComplete;  // of the end, once there is one
  std::stop_source over_;
  std::chrono::steady_clock::time_point next_observation_ = std::chrono::steady_clock::now();
  std::stop_callback<std::function<void()>> on_stop_;  // the last: it may be called before it is made
};

/// Tells a watch of the cells that a worker adds.
class CellMeter {
 public:
  template <class Worker>
  void report(const Worker& worker, Watch& watch) {
    watch.add_cells(worker.net_cells() - reported_);
    reported_ = worker.net_cells();
  }

 private:
  std::int64_t reported_ = 0;
};

/// Seconds that one worker did not bring the mesh on, by cause.
struct Overhead {
  double contention_s = 0, begging_s = 0, rollback_s = 0;
};

class SerialExecutor {
 public:
  explicit SerialExecutor(Watch& watch) : watch_(watch) {}

  /// Runs until the worker's poor element list is empty or something ends the run, always between operations.
  StopReason run(Worker<NoLocks>& worker);

 private:
  Watch& watch_;
};

}  // namespace podm
