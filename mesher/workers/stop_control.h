// When a run ends: for limits, or because somebody asks for it. Workers look here between operations.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

#include "podm/choices.h"
#include "podm/limits.h"

namespace podm {

/// Shared by all workers of a run, and by its phases. Any thread may call, but for those that say so.
class StopControl {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int kAttemptsBetweenChecks = 1 << 8;  // a worker makes them in well below a millisecond

  /// Cells are those of the store, and seconds count from `start`; lack of memory shows itself.
  /// `observe(cells)` is called a few times a second. Whoever requests the stop ends the run, so that over()
  /// tells of it even while nobody asks for reasons.
  StopControl(const Limits& limits, std::stop_token stop, std::function<void(std::uint64_t)> observe,
              Clock::time_point start = Clock::now())
      : max_elements_(static_cast<std::int64_t>(limits.max_elements)),
        max_cells_(max_elements_),
        deadline_(limits.max_seconds > 0 ? start + std::chrono::duration_cast<Clock::duration>(
                                                       std::chrono::duration<double>(limits.max_seconds))
                                         : Clock::time_point::max()),
        observe_(std::move(observe)),
        on_stop_(std::move(stop), [this] { end(StopReason::kCancelled); }) {}

  /// All stores together have so many cells: from now on this one may grow by one of so many even shares of
  /// what the limit leaves. Between phases.
  void share_limit(std::int64_t cells_of_all, int num_shares);
  /// The store has so many more cells.
  void add_cells(std::int64_t more) { num_cells_.fetch_add(more, std::memory_order_relaxed); }
  /// Those that were added.
  std::int64_t num_cells() const { return num_cells_; }
  /// Ends the run if a limit is passed.
  void check_limits();
  /// Ends the run. The first reason counts.
  void end(StopReason reason);
  /// kComplete as long as nothing has ended it.
  StopReason reason() const { return reason_; }
  /// Relaxed: a worker that has not heard of the end yet does one more operation.
  bool is_over() const { return reason_.load(std::memory_order_relaxed) != StopReason::kComplete; }
  /// Requested when the run has to end.
  std::stop_token over() const { return over_.get_token(); }
  /// Only the thread that the run was called from calls these.
  void observe();
  /// From now on observe() calls this, soon for the first time.
  void observe_by(std::function<void(std::uint64_t)> observe) {
    observe_ = std::move(observe);
    next_observation_ = Clock::now();
  }

 private:
  const std::int64_t max_elements_;  // of all stores; 0: any number
  std::int64_t max_cells_;           // of this one
  Clock::time_point deadline_;
  std::function<void(std::uint64_t)> observe_;
  std::atomic<std::int64_t> num_cells_ = 0;
  std::atomic<StopReason> reason_ = StopReason::kComplete;  // the end's, once there is one
  std::stop_source over_;
  Clock::time_point next_observation_ = Clock::now();
  std::stop_callback<std::function<void()>> on_stop_;  // the last: it may be called before it is made
};

/// Tells of the cells that a worker adds.
class CellMeter {
 public:
  template <class Worker>
  void report(const Worker& worker, StopControl& stop) {
    stop.add_cells(worker.net_cells() - reported_);
    reported_ = worker.net_cells();
  }

 private:
  std::int64_t reported_ = 0;
};

}  // namespace podm
