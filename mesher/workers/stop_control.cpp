#include "workers/stop_control.h"

#include <algorithm>

namespace podm {

namespace {

constexpr auto kObservationInterval = std::chrono::milliseconds(200);

}  // namespace

void StopControl::check_limits() {
  const std::int64_t cells = num_cells_.load(std::memory_order_relaxed);
  if (limits_.max_cells > 0 && cells > static_cast<std::int64_t>(limits_.max_cells)) {
    end(StopReason::kElementLimit);
  } else if (std::chrono::steady_clock::now() > limits_.deadline) {
    end(StopReason::kTimeLimit);
  }
}

void StopControl::end(StopReason reason) {
  StopReason none = StopReason::kComplete;
  reason_.compare_exchange_strong(none, reason);
  over_.request_stop();
}

void StopControl::observe() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_observation_) return;
  observe_(static_cast<std::uint64_t>(std::max<std::int64_t>(num_cells_, 0)));
  next_observation_ = now + kObservationInterval;
}

}  // namespace podm
