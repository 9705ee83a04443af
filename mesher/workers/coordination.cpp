#include "workers/coordination.h"

#include <algorithm>

#include "podm/errors.h"

namespace podm {

Coordination::Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume,
                           WorkerId first_id)
    : contention_(options.contention, options.num_workers, options.seed),
      begging_(options.num_workers, options.groups),
      members_(static_cast<std::size_t>(options.num_workers)),
      workers_per_home_(static_cast<WorkerId>(options.workers_per_home)),
      homes_(workers_per_home_ == 0 ? 0 : members_.size() / workers_per_home_),
      resume_(std::move(resume)),
      first_id_(first_id) {
  if (workers_per_home_ != 0 && members_.size() % workers_per_home_ != 0)
    throw InternalError("the number of homes must divide the number of workers");
}

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

void Coordination::send(unsigned home, const Entries& cells) {
  Home& to = homes_[home];
  {
    const std::scoped_lock lock(to.mutex);
    to.cells.insert(to.cells.end(), cells.begin(), cells.end());
  }
  serve(home);
}

// Gives cells of the home to its begging workers, until none of them begs or no cells are left. The hints of
// may_serve() include every worker that was listed before the home's lock was acquired.
void Coordination::serve(unsigned home) {
  Home& from = homes_[home];
  for (WorkerId i = 0; i < workers_per_home_; ++i) {
    const WorkerId worker = home * workers_per_home_ + i;
    while (has_cells(from) && begging_.may_serve(worker)) {
      const BeggingList::Beggar beggar = begging_.take_first_for(worker);
      if (beggar.worker != kNoWorker) give(beggar.worker, take_from(from));
    }
  }
}

bool Coordination::has_cells(Home& home) {
  const std::scoped_lock lock(home.mutex);
  return !home.cells.empty();
}

Coordination::Entries Coordination::take_from(Home& home) {
  const std::scoped_lock lock(home.mutex);
  const auto count = static_cast<std::ptrdiff_t>(std::min(kMostToShare, home.cells.size()));
  Entries taken(home.cells.end() - count, home.cells.end());
  home.cells.erase(home.cells.end() - count, home.cells.end());
  if (home.cells.empty()) home.cells.shrink_to_fit();
  return taken;
}

Coordination::Begging Coordination::look_home_or_join(WorkerId self) {
  const auto join = [&] { return begging_.add(self) ? Begging::kListed : Begging::kOver; };
  if (homes_.empty()) return join();
  Home& home = homes_[self / workers_per_home_];
  const std::scoped_lock lock(home.mutex);
  return home.cells.empty() ? join() : Begging::kHasGift;
}

Coordination::Begging Coordination::beg(WorkerId id) {
  const WorkerId self = id - first_id_;
  for (const WorkerId waiting : contention_.begin_to_beg(self)) resume(waiting);
  const Begging answer = look_home_or_join(self);
  if (answer == Begging::kHasGift) {
    contention_.run_again(self);
    Entries gift = take_from(homes_[self / workers_per_home_]);  // may be empty: another worker may be faster
    const std::scoped_lock lock(members_[self].mutex);
    members_[self].gift = std::move(gift);
  }
  if (answer != Begging::kListed) return answer;
  const bool is_last = ++num_begging_ == static_cast<int>(members_.size());
  if (!is_last) return answer;
  // Only this worker is left to take the master off its list.
  begging_.remove(kMaster);
  if (self == kMaster) {
    --num_begging_;
    contention_.run_again(kMaster);
    return Begging::kOver;
  }
  end_begging(kMaster);  // it begs again and finds that no worker has cells
  return Begging::kListed;
}

Coordination::Entries Coordination::take_gift(WorkerId self) {
  Member& member = members_[self - first_id_];
  const std::scoped_lock lock(member.mutex);
  return std::exchange(member.gift, {});
}

// A worker that begs again meanwhile may be woken twice, but the number of rounds is bounded.
void Coordination::wake_beggars(WorkerId self) {
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
