#include "workers/coordination.h"

namespace podm {

Coordination::Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume,
                           WorkerId first_id)
    : contention_(options.contention, options.num_workers, options.seed),
      begging_(options.num_workers, options.groups),
      members_(static_cast<std::size_t>(options.num_workers)),
      resume_(std::move(resume)),
      first_id_(first_id) {}

Coordination::Answer Coordination::conflict(WorkerId self, WorkerId holder) {
  members_[self].successes = 0;
  const int in_a_row = ++members_[self].conflicts;
  const bool is_ours = holder < members_.size();
  return is_ours ? contention_.conflict(self, holder, in_a_row) : Answer{};
}

void Coordination::wake_one(WorkerId self) {
  const WorkerId waiting = contention_.wake(self);
  if (waiting != kNoWorker) resume(waiting);
}

void Coordination::give(WorkerId beggar, Entries cells) {
  {
    const std::scoped_lock lock(members_[beggar].mutex);
    members_[beggar].gift = std::move(cells);
  }
  end_begging(beggar);
}

void Coordination::end_begging(WorkerId beggar) {
  --num_begging_;
  contention_.run_again(beggar);
  resume(beggar);
}

bool Coordination::beg(WorkerId id) {
  const WorkerId self = id - first_id_;
  for (const WorkerId waiting : contention_.begin_to_beg(self)) resume(waiting);
  if (!begging_.add(self)) return false;
  const bool is_last = ++num_begging_ == static_cast<int>(members_.size());
  if (!is_last) return true;
  // None is left to take the master off the list but this worker.
  begging_.remove(kMaster);
  if (self == kMaster) {
    --num_begging_;
    contention_.run_again(kMaster);
    return false;
  }
  end_begging(kMaster);  // it shall see that nobody has cells
  return true;
}

Coordination::Entries Coordination::take_gift(WorkerId self) {
  Member& member = members_[self - first_id_];
  const std::scoped_lock lock(member.mutex);
  return std::exchange(member.gift, {});
}

// Who begs again meanwhile may be roused twice, but not for ever.
void Coordination::rouse(WorkerId self) {
  for (std::size_t others = members_.size() - 1; others > 0; --others) {
    const BeggingList::Beggar beggar = begging_.take_first_for(self - first_id_);
    if (beggar.worker == kNoWorker) return;
    give(beggar.worker, {});
  }
}

void Coordination::dismiss() {
  for (const WorkerId beggar : begging_.close()) end_begging(beggar);
}

}  // namespace podm
