#include "workers/contention_manager.h"

namespace podm {

ContentionManager::ContentionManager(Contention kind, int num_workers, std::uint64_t seed)
    : kind_(kind), lists_(static_cast<std::size_t>(num_workers)), random_(seed) {}

auto ContentionManager::conflict(WorkerId self, WorkerId holder, int in_a_row, const Activity& activity)
    -> Answer {
  switch (kind_) {
    case Contention::kAggressive:
      return {};
    case Contention::kRandom:
      if (in_a_row < kConflictsToPause) return {};
      return {Answer::kPause, 1e-3 * std::uniform_real_distribution(1.0, double{kConflictsToPause})(random_)};
    case Contention::kGlobal:
    case Contention::kLocal:
      break;
  }
  if (activity.num_running() == 1) return {};
  if (kind_ == Contention::kLocal && activity.of(holder) != Activity::State::kRunning) return {};
  list_of(holder).push_back(self);
  ++num_waiting_;
  return {Answer::kWait, 0};
}

WorkerId ContentionManager::wake(WorkerId self) {
  auto& list = list_of(self);
  if (list.empty()) return kNoWorker;
  const WorkerId first = list.front();
  list.pop_front();
  --num_waiting_;
  return first;
}

std::vector<WorkerId> ContentionManager::idle(WorkerId self, const Activity& activity) {
  if (kind_ == Contention::kGlobal && activity.num_running() > 1) return {};
  std::vector<WorkerId> woken;
  for (WorkerId worker = wake(self); worker != kNoWorker; worker = wake(self)) woken.push_back(worker);
  return woken;
}

}  // namespace podm
