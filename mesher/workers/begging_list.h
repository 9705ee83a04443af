// The begging list: idle workers request cells here. A busy worker that has enough cells gives some to the
// first worker that it serves. Givers push; no worker takes cells from another worker's poor element list.
// Foteinos, Chrisochoides, JPDC 74 (2014), section 6:
//   random        one list for all, first come first served
//   hierarchical  one list per group of workers, level by level: socket, node, machine. A begging worker is
//                 on the list of its own group. The last of a group to beg is on the list of the group around
//                 it. Givers serve the nearest group first, so that most cells stay near their memory.
//
// Each list has its own lock, and no call holds two locks. Most calls take one or two locks.
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "runtime/worker_id.h"

namespace podm {

/// groups[level][worker] is the group of the worker. Level 0 has the smallest groups; groups nest. The
/// machine, which holds all workers, is not listed: with no levels the begging list is random.
using WorkerGroups = std::vector<std::vector<int>>;

/// Any worker may make any call at any time.
class BeggingList {
 public:
  BeggingList(int num_workers, WorkerGroups groups);

  /// Returns false if the list is closed. The worker must not be on the list.
  bool add(WorkerId worker);
  struct Beggar {
    WorkerId worker = kNoWorker;
    std::size_t level = 0;  // of the list that it was on
  };
  /// Takes the begging worker that `giver` should serve off its list. Returns kNoWorker if `giver` sees none.
  /// The last worker that does not beg sees one.
  Beggar take_first_for(WorkerId giver);
  /// Puts the worker back at the front of its list, which must not have been closed meanwhile.
  void put_back(const Beggar& beggar);
  /// A hint: true if take_first_for(giver) would return a worker.
  bool may_serve(WorkerId giver) const;
  /// Takes `worker` off its list, if it is on one.
  void remove(WorkerId worker);
  /// Closes all lists: no worker is added any more. Returns the workers that were on them.
  std::vector<WorkerId> close();

 private:
  struct alignas(64) Group {
    std::mutex mutex;
    std::deque<WorkerId> beggars;  // first come first
    std::atomic<int> num_beggars = 0;
    int num_members = 0;  // workers, or groups of the level below
    bool is_closed = false;
  };
  enum class Added { kListed, kFull, kClosed };
  Group& group_of(std::size_t level, WorkerId worker) const {
    return levels_[level][static_cast<std::size_t>(groups_[level][worker])];
  }
  bool is_machine(std::size_t level) const { return level + 1 == levels_.size(); }
  Added add_to(Group& group, WorkerId worker, int most_beggars);
  static void count(Group& group);

  WorkerGroups groups_;  // the machine last
  std::vector<std::unique_ptr<Group[]>> levels_;
  std::vector<int> num_groups_;  // indexed by level
};

}  // namespace podm
