#include "refine/coordination.h"

namespace podm {

Coordination::Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume)
    : activity_(options.num_workers),
      contention_(options.contention, options.num_workers, options.seed),
      begging_(options.num_workers, options.groups),
      gifts_(static_cast<std::size_t>(options.num_workers)),
      resume_(std::move(resume)) {}

ContentionManager::Answer Coordination::conflict(WorkerId self, WorkerId holder, int in_a_row) {
  const bool is_ours = holder < gifts_.size();
  if (!is_ours) return {};
  const auto answer = contention_.conflict(self, holder, in_a_row, activity_);
  if (answer.kind == ContentionManager::Answer::kWait) activity_.set(self, Activity::State::kWaiting);
  return answer;
}

void Coordination::wake_one(WorkerId self) {
  const WorkerId waiting = contention_.wake(self);
  if (waiting != kNoWorker) resume(waiting);
}

bool Coordination::beg(WorkerId self) {
  for (const WorkerId waiting : contention_.idle(self, activity_)) resume(waiting);
  activity_.set(self, Activity::State::kBegging);
  begging_.add(self);
  return activity_.num_running() > 0;  // if not, nobody waits either: the last to stop running has woken them
}

void Coordination::give(WorkerId beggar, Entries cells) {
  begging_.remove(beggar);
  gifts_[beggar] = std::move(cells);
  resume(beggar);
}

void Coordination::resume(WorkerId worker) {
  activity_.set(worker, Activity::State::kRunning);
  resume_(worker);
}

}  // namespace podm
