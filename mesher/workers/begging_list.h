// The begging list: idle workers ask here for cells; a busy worker that has enough gives some to the first it
// serves. Givers push; nobody takes from another's list. Foteinos, Chrisochoides, JPDC 74 (2014), section 6:
//   random        one list for all, first come first served
//   hierarchical  a list for each group of workers, level by level: socket, node, machine. A beggar is seen
//                 in its own group; by the group around that one only once all of its group beg. Givers
//                 serve the nearest first, so that most cells stay near the memory they lie in.
// Its caller makes sure that one call is made at a time, but for may_serve().
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "delaunay/vertex_locks.h"

namespace podm {

/// groups[level][worker]: the group it is in, level 0 the smallest; groups nest. The machine, which holds
/// all, goes without saying: no level at all makes the list random.
using WorkerGroups = std::vector<std::vector<int>>;

class BeggingList {
 public:
  BeggingList(int num_workers, WorkerGroups groups);

  void add(WorkerId worker);
  void remove(WorkerId worker);
  /// The beggar that `giver` should serve; kNoWorker: it sees none.
  WorkerId first_for(WorkerId giver) const;
  /// A hint that anyone may ask for at any time: whether first_for(giver) would name somebody.
  bool may_serve(WorkerId giver) const;

 private:
  struct Group {
    int size = 0, num_begging = 0;
    std::atomic<int> num_visible = 0;  // beggars that its members see
  };
  Group& group_of(std::size_t level, WorkerId worker) const {
    return levels_[level][static_cast<std::size_t>(groups_[level][worker])];
  }
  // Levels up to which the beggar is seen.
  std::size_t reach_of(WorkerId beggar) const;
  void count_visible();

  WorkerGroups groups_;  // the machine last
  std::vector<std::unique_ptr<Group[]>> levels_;
  std::vector<WorkerId> beggars_;  // first come first
};

}  // namespace podm
