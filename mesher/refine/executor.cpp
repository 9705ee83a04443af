#include "refine/executor.h"

#include <algorithm>
#include <new>

namespace podm {

namespace {

constexpr auto kObservationInterval = std::chrono::milliseconds(200);

}  // namespace

std::optional<StopReason> Watch::reason_to_stop() {
  if (const StopReason reason = reason_; reason != StopReason::kComplete) return reason;
  const std::int64_t cells = num_cells_.load(std::memory_order_relaxed);
  if (limits_.max_cells > 0 && cells > static_cast<std::int64_t>(limits_.max_cells)) {
    end(StopReason::kElementLimit);
  } else if (std::chrono::steady_clock::now() > limits_.deadline) {
    end(StopReason::kTimeLimit);
  } else {
    return std::nullopt;
  }
  return reason_;
}

void Watch::end(StopReason reason) {
  StopReason none = StopReason::kComplete;
  reason_.compare_exchange_strong(none, reason);
  over_.request_stop();
}

void Watch::observe() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_observation_) return;
  observe_(static_cast<std::uint64_t>(std::max<std::int64_t>(num_cells_, 0)));
  next_observation_ = now + kObservationInterval;
}

StopReason SerialExecutor::run(Worker<NoLocks>& worker) try {
  CellMeter meter;
  while (worker.has_work()) {
    for (int i = 0; i < Watch::kAttemptsBetweenChecks && worker.has_work(); ++i) {
      worker.attempt();
      worker.release();
    }
    meter.report(worker, watch_);
    if (const auto reason = watch_.reason_to_stop()) return *reason;
    watch_.observe();
  }
  return StopReason::kComplete;
} catch (const std::bad_alloc&) {
  watch_.end(StopReason::kMemoryLimit);
  return StopReason::kMemoryLimit;
}

}  // namespace podm
