// Ends a run at a limit or on request. Workers check it between operations.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <stop_token>

#include "podm/choices.h"
#include "podm/limits.h"

namespace podm {

/// Shared by all workers of a run and by its phases. Any thread may call, except where noted.
class StopControl {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int kAttemptsBetweenChecks = 1 << 8;  // a worker makes them in well below a millisecond
  // A worker adds these cells in some ten milliseconds. If 256 workers reported at each check, the cache line
  // of the number would pass from one to the next millions of times per second.
  static constexpr std::int64_t kLongestReportingStep = 1 << 14;

  /// Limits the cells of the store, and the seconds from `start` on. A lack of memory shows itself.
  /// `observe(cells)` is called a few times per second. A request of `stop` ends the run at once, so that
  /// over() shows it even while no worker checks.
  StopControl(const Limits& limits, std::stop_token stop, std::function<void(std::uint64_t)> observe,
              Clock::time_point start = Clock::now())
      : max_elements_(static_cast<std::int64_t>(limits.max_elements)),
        max_cells_(max_elements_),
        deadline_(limits.max_seconds > 0 ? start + std::chrono::duration_cast<Clock::duration>(
                                                       std::chrono::duration<double>(limits.max_seconds))
                                         : Clock::time_point::max()),
        observe_(std::move(observe)),
        on_stop_(std::move(stop), [this] { end(StopReason::kCancelled); }) {}

  /// All stores together have `cells_of_all` cells. From now on this store may grow by `share`, from
  /// 0 to 1, of what the limit leaves. To be called between phases.
  void share_limit(std::int64_t cells_of_all, double share);
  /// The most cells of all stores together; 0: any number.
  std::int64_t max_elements() const { return max_elements_; }
  /// The store has `more` additional cells.
  void add_cells(std::int64_t more) { num_cells_.fetch_add(more, std::memory_order_relaxed); }
  /// The number of cells added.
  std::int64_t num_cells() const { return num_cells_; }
  /// The number of cells that each of `num_workers` workers may keep unreported: together a fourth of what
  /// the limit leaves, so that the end is not missed. Without a limit only observe() reads the number.
  std::int64_t reporting_step(std::size_t num_workers) const {
    if (max_elements_ == 0) return kLongestReportingStep;
    const std::int64_t left = max_cells_ - num_cells_.load(std::memory_order_relaxed);
    return std::clamp<std::int64_t>(left / (4 * static_cast<std::int64_t>(num_workers)), 0,
                                    kLongestReportingStep);
  }
  /// Ends the run if a limit is exceeded.
  void check_limits();
  /// Ends the run. The first reason counts.
  void end(StopReason reason);
  /// Returns kComplete as long as the run has not been ended.
  StopReason reason() const { return reason_; }
  /// Relaxed: a worker that does not see the end yet does one more operation.
  bool is_over() const { return reason_.load(std::memory_order_relaxed) != StopReason::kComplete; }
  /// A stop is requested of this token when the run has to end.
  std::stop_token over() const { return over_.get_token(); }
  /// This function and the next may only be called by the thread that called the run.
  void observe();
  /// From now on observe() calls this function, for the first time at its next call.
  void observe_by(std::function<void(std::uint64_t)> observe) {
    observe_ = std::move(observe);
    next_observation_ = Clock::now();
  }

 private:
  const std::int64_t max_elements_;  // of all stores; 0: any number
  std::int64_t max_cells_;           // of this one
  Clock::time_point deadline_;
  std::function<void(std::uint64_t)> observe_;
  Clock::time_point next_observation_ = Clock::now();
  std::stop_source over_;
  // In different cache lines: each worker reads the reason at each attempt, and writes the number now and
  // then.
  alignas(128) std::atomic<std::int64_t> num_cells_ = 0;
  alignas(128) std::atomic<StopReason> reason_ = StopReason::kComplete;  // kComplete until the end
  std::stop_callback<std::function<void()>> on_stop_;  // last: it may be called while it is constructed
};

/// Reports the cells that a worker adds.
class CellMeter {
 public:
  template <class Worker>
  void report(const Worker& worker, StopControl& stop) {
    stop.add_cells(worker.net_cells() - reported_);
    reported_ = worker.net_cells();
  }
  /// Reports once the cells of one of `num_workers` workers are as many as one report is worth.
  template <class Worker>
  void report_if_due(const Worker& worker, std::size_t num_workers, StopControl& stop) {
    if (std::abs(worker.net_cells() - reported_) >= stop.reporting_step(num_workers)) report(worker, stop);
  }

 private:
  std::int64_t reported_ = 0;
};

}  // namespace podm
