#include "workers/coordination.h"

namespace podm {

Coordination::Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume,
                           WorkerId first_id)
    : activity_(options.num_workers),
      contention_(options.contention, options.num_workers, options.seed),
      begging_(options.num_workers, options.groups),
      gifts_(static_cast<std::size_t>(options.num_workers)),
      streaks_(static_cast<std::size_t>(options.num_workers)),
      resume_(std::move(resume)),
      first_id_(first_id) {}

Coordination::Answer Coordination::conflict(WorkerId self, WorkerId holder) {
  streaks_[self].successes = 0;
  const int in_a_row = ++streaks_[self].conflicts;
  const bool is_ours = holder < gifts_.size();
  if (!is_ours) return {};
  const std::scoped_lock lock(mutex_);
  const Answer answer = contention_.conflict(self, holder, in_a_row, activity_);
  if (answer.kind == Answer::kWait) activity_.set(self, Activity::State::kWaiting);
  return answer;
}

void Coordination::wake_one(WorkerId self) {
  const std::scoped_lock lock(mutex_);
  const WorkerId waiting = contention_.wake(self);
  if (waiting != kNoWorker) resume(waiting);
}

bool Coordination::beg(WorkerId id) {
  const WorkerId self = id - first_id_;
  const std::scoped_lock lock(mutex_);
  if (is_dismissed_) return false;
  for (const WorkerId waiting : contention_.idle(self, activity_)) resume(waiting);
  const bool is_last =
      activity_.num_running() == 1;  // then nobody waits either: it has just woken those who did
  if (is_last && self == kMaster) return false;
  activity_.set(self, Activity::State::kBegging);
  begging_.add(self);
  if (is_last) end_begging(kMaster);  // to see that nobody has cells
  return true;
}

Coordination::Entries Coordination::take_gift(WorkerId self) {
  const std::scoped_lock lock(mutex_);
  return std::exchange(gifts_[self - first_id_], {});
}

void Coordination::dismiss() {
  const std::scoped_lock lock(mutex_);
  is_dismissed_ = true;
  for (WorkerId worker = 0; worker < gifts_.size(); ++worker)  // others have not begun yet
    if (activity_.of(worker) == Activity::State::kBegging) end_begging(worker);
}

void Coordination::end_begging(WorkerId beggar) {
  begging_.remove(beggar);
  resume(beggar);
}

void Coordination::resume(WorkerId worker) {
  activity_.set(worker, Activity::State::kRunning);
  resume_(first_id_ + worker);
}

}  // namespace podm
