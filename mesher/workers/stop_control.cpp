#include "workers/stop_control.h"

#include <algorithm>

namespace podm {

namespace {

constexpr auto kObservationInterval = std::chrono::milliseconds(200);

}  // namespace

void StopControl::check_limits() {
  const std::int64_t cells = num_cells_.load(std::memory_order_relaxed);
  if (max_elements_ > 0 && cells > max_cells_) {
    end(StopReason::kElementLimit);
  } else if (Clock::now() > deadline_) {
    end(StopReason::kTimeLimit);
  }
}

void StopControl::share_limit(std::int64_t cells_of_all, double share) {
  const std::int64_t left = std::max<std::int64_t>(0, max_elements_ - cells_of_all);
  max_cells_ = num_cells_ + static_cast<std::int64_t>(share * static_cast<double>(left));
}

void StopControl::end(StopReason reason) {
  StopReason none = StopReason::kComplete;
  reason_.compare_exchange_strong(none, reason);
  over_.request_stop();
}

void StopControl::observe() {
  const auto now = Clock::now();
  if (now < next_observation_) return;
  observe_(static_cast<std::uint64_t>(std::max<std::int64_t>(num_cells_, 0)));
  next_observation_ = now + kObservationInterval;
}

}  // namespace podm
