#include "refine/executor.h"

#include <new>

namespace podm {

namespace {

constexpr int kAttemptsBetweenChecks = 1 << 8;  // well below a millisecond
constexpr auto kObservationInterval = std::chrono::milliseconds(200);
// The most cells one operation is allowed to need beyond what it frees: a bound on ids, not on work.
constexpr std::size_t kReserveCells = 1 << 16;

}  // namespace

StopReason SerialExecutor::run(Worker<NoLocks>& worker, const Mesh& mesh) {
  auto next_observation = std::chrono::steady_clock::now();
  while (worker.has_work()) {
    for (int i = 0; i < kAttemptsBetweenChecks && worker.has_work(); ++i) worker.attempt();
    const auto cells = static_cast<std::uint64_t>(worker.net_cells());
    if (stop_.stop_requested()) return StopReason::kCancelled;
    if (limits_.max_cells > 0 && cells > limits_.max_cells) return StopReason::kElementLimit;
    if (mesh.cell_bound() + kReserveCells > mesh.cell_capacity()) return StopReason::kMemoryLimit;
    const auto now = std::chrono::steady_clock::now();
    if (now > limits_.deadline) return StopReason::kTimeLimit;
    if (now >= next_observation) {
      observe_(cells);
      next_observation = now + kObservationInterval;
    }
  }
  return StopReason::kComplete;
}

}  // namespace podm
