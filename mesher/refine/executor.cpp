#include "refine/executor.h"

#include <new>

namespace podm {

namespace {

constexpr auto kObservationInterval = std::chrono::milliseconds(200);

}  // namespace

std::optional<StopReason> Watch::reason_to_stop(std::uint64_t cells) const {
  if (stop_.stop_requested()) return StopReason::kCancelled;
  if (limits_.max_cells > 0 && cells > limits_.max_cells) return StopReason::kElementLimit;
  if (std::chrono::steady_clock::now() > limits_.deadline) return StopReason::kTimeLimit;
  return std::nullopt;
}

void Watch::observe(std::uint64_t cells) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_observation_) return;
  observe_(cells);
  next_observation_ = now + kObservationInterval;
}

StopReason SerialExecutor::run(Worker<NoLocks>& worker) try {
  while (worker.has_work()) {
    for (int i = 0; i < Watch::kAttemptsBetweenChecks && worker.has_work(); ++i) {
      worker.attempt();
      worker.release();
    }
    const auto cells = static_cast<std::uint64_t>(worker.net_cells());
    if (const auto reason = watch_.reason_to_stop(cells)) return *reason;
    watch_.observe(cells);
  }
  return StopReason::kComplete;
} catch (const std::bad_alloc&) {
  return StopReason::kMemoryLimit;
}

}  // namespace podm
