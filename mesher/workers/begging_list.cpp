#include "workers/begging_list.h"

#include <algorithm>

namespace podm {

BeggingList::BeggingList(int num_workers, WorkerGroups groups) : groups_(std::move(groups)) {
  groups_.emplace_back(static_cast<std::size_t>(num_workers), 0);
  for (const std::vector<int>& level : groups_) {
    levels_.push_back(std::make_unique<Group[]>(
        1 + static_cast<std::size_t>(*std::max_element(level.begin(), level.end()))));
    for (const int group : level) ++levels_.back()[static_cast<std::size_t>(group)].size;
  }
}

void BeggingList::add(WorkerId worker) {
  beggars_.push_back(worker);
  for (std::size_t level = 0; level < levels_.size(); ++level) ++group_of(level, worker).num_begging;
  count_visible();
}

void BeggingList::remove(WorkerId worker) {
  beggars_.erase(std::find(beggars_.begin(), beggars_.end(), worker));
  for (std::size_t level = 0; level < levels_.size(); ++level) --group_of(level, worker).num_begging;
  count_visible();
}

std::size_t BeggingList::reach_of(WorkerId beggar) const {
  std::size_t level = 0;
  while (level + 1 < levels_.size() && group_of(level, beggar).num_begging == group_of(level, beggar).size)
    ++level;
  return level;
}

// Relaxed: only a hint, first_for() looks again.
void BeggingList::count_visible() {
  for (std::size_t level = 0; level < levels_.size(); ++level)
    for (const int group : groups_[level])
      levels_[level][static_cast<std::size_t>(group)].num_visible.store(0, std::memory_order_relaxed);
  for (const WorkerId beggar : beggars_)
    for (std::size_t level = 0; level <= reach_of(beggar); ++level)
      group_of(level, beggar).num_visible.fetch_add(1, std::memory_order_relaxed);
}

bool BeggingList::may_serve(WorkerId giver) const {
  for (std::size_t level = 0; level < levels_.size(); ++level)
    if (group_of(level, giver).num_visible.load(std::memory_order_relaxed) > 0) return true;
  return false;
}

WorkerId BeggingList::first_for(WorkerId giver) const {
  for (std::size_t level = 0; level < levels_.size(); ++level)
    for (const WorkerId beggar : beggars_)
      if (groups_[level][beggar] == groups_[level][giver] && level <= reach_of(beggar)) return beggar;
  return kNoWorker;
}

}  // namespace podm
