#include "workers/begging_list.h"

#include <algorithm>
#include <limits>
#include <set>

namespace podm {

namespace {

// Returns the number of workers in a smallest group, or the number of groups of the level below in any other
// group.
int num_members(const WorkerGroups& groups, std::size_t level, int group) {
  std::set<int> members;
  for (std::size_t worker = 0; worker < groups[level].size(); ++worker)
    if (groups[level][worker] == group)
      members.insert(level == 0 ? static_cast<int>(worker) : groups[level - 1][worker]);
  return static_cast<int>(members.size());
}

}  // namespace

BeggingList::BeggingList(int num_workers, WorkerGroups groups) : groups_(std::move(groups)) {
  groups_.emplace_back(static_cast<std::size_t>(num_workers), 0);
  for (std::size_t level = 0; level < groups_.size(); ++level) {
    num_groups_.push_back(1 + *std::max_element(groups_[level].begin(), groups_[level].end()));
    const auto count = static_cast<std::size_t>(num_groups_.back());
    levels_.push_back(std::make_unique<Group[]>(count));
    for (std::size_t group = 0; group < count; ++group)
      levels_[level][group].num_members = num_members(groups_, level, static_cast<int>(group));
  }
}

// A worker that would fill a list is the last of its group to beg, and goes to the list of the next level.
bool BeggingList::add(WorkerId worker) {
  for (std::size_t level = 0;; ++level) {
    Group& group = group_of(level, worker);
    const int most_beggars = is_machine(level) ? std::numeric_limits<int>::max() : group.num_members - 1;
    const Added added = add_to(group, worker, most_beggars);
    if (added != Added::kFull) return added == Added::kListed;
  }
}

BeggingList::Added BeggingList::add_to(Group& group, WorkerId worker, int most_beggars) {
  const std::scoped_lock lock(group.mutex);
  if (group.is_closed) return Added::kClosed;
  if (static_cast<int>(group.beggars.size()) >= most_beggars) return Added::kFull;
  group.beggars.push_back(worker);
  count(group);
  return Added::kListed;
}

BeggingList::Beggar BeggingList::take_first_for(WorkerId giver) {
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    Group& group = group_of(level, giver);
    const std::scoped_lock lock(group.mutex);
    if (group.beggars.empty()) continue;
    const WorkerId first = group.beggars.front();
    group.beggars.pop_front();
    count(group);
    return {first, level};
  }
  return {};
}

void BeggingList::put_back(const Beggar& beggar) {
  Group& group = group_of(beggar.level, beggar.worker);
  const std::scoped_lock lock(group.mutex);
  group.beggars.push_front(beggar.worker);
  count(group);
}

bool BeggingList::may_serve(WorkerId giver) const {
  for (std::size_t level = 0; level < levels_.size(); ++level)
    if (group_of(level, giver).num_beggars.load(std::memory_order_relaxed) > 0) return true;
  return false;
}

void BeggingList::remove(WorkerId worker) {
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    Group& group = group_of(level, worker);
    const std::scoped_lock lock(group.mutex);
    std::erase(group.beggars, worker);
    count(group);
  }
}

// Closes the lists from the smallest groups upwards, in the order of add(). A worker that finds a list full
// either reaches the next list before it is closed, and is returned, or finds that list closed.
std::vector<WorkerId> BeggingList::close() {
  std::vector<WorkerId> beggars;
  for (std::size_t level = 0; level < levels_.size(); ++level)
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_groups_[level]); ++i) {
      Group& group = levels_[level][i];
      const std::scoped_lock lock(group.mutex);
      beggars.insert(beggars.end(), group.beggars.begin(), group.beggars.end());
      group.beggars.clear();
      group.is_closed = true;
      count(group);
    }
  return beggars;
}

// The count is only a hint for threads that do not hold the lock.
void BeggingList::count(Group& group) {
  group.num_beggars.store(static_cast<int>(group.beggars.size()), std::memory_order_relaxed);
}

}  // namespace podm
