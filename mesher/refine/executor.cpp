#include "refine/executor.h"

namespace podm {

namespace {

constexpr auto kObservationInterval = std::chrono::milliseconds(200);
// The most cells that a worker may need beyond what it frees until the next check: a bound on ids, not on
// work.
constexpr std::size_t kReserveCells = 1 << 16;

}  // namespace

std::optional<StopReason> Watch::reason_to_stop(std::uint64_t cells, const Mesh& mesh,
                                                std::size_t num_workers) const {
  if (stop_.stop_requested()) return StopReason::kCancelled;
  if (limits_.max_cells > 0 && cells > limits_.max_cells) return StopReason::kElementLimit;
  if (mesh.cell_bound() + num_workers * kReserveCells > mesh.cell_capacity()) return StopReason::kMemoryLimit;
  if (std::chrono::steady_clock::now() > limits_.deadline) return StopReason::kTimeLimit;
  return std::nullopt;
}

void Watch::observe(std::uint64_t cells) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_observation_) return;
  observe_(cells);
  next_observation_ = now + kObservationInterval;
}

StopReason SerialExecutor::run(Worker<NoLocks>& worker, const Mesh& mesh) {
  while (worker.has_work()) {
    for (int i = 0; i < Watch::kAttemptsBetweenChecks && worker.has_work(); ++i) worker.attempt();
    const auto cells = static_cast<std::uint64_t>(worker.net_cells());
    if (const auto reason = watch_.reason_to_stop(cells, mesh, 1)) return *reason;
    watch_.observe(cells);
  }
  return StopReason::kComplete;
}

}  // namespace podm
