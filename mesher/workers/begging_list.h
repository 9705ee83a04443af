// The begging list: idle workers ask here for cells; a busy worker that has enough gives some to the first it
// serves. Givers push; nobody takes from another's list. Foteinos, Chrisochoides, JPDC 74 (2014), section 6:
//   random        one list for all, first come first served
//   hierarchical  a list for each group of workers, level by level: socket, node, machine. A beggar is on the
//                 list of its own group; the last of a group to beg, on that of the group around it. Givers
//                 serve the nearest first, so that most cells stay near the memory they lie in.
//
// Each list has a lock of its own, and no call holds two. A call takes one or two of them as a rule.
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "runtime/worker_id.h"

namespace podm {

/// groups[level][worker]: the group it is in, level 0 the smallest; groups nest. The machine, which holds
/// all, goes without saying: no level at all makes the list random.
using WorkerGroups = std::vector<std::vector<int>>;

/// Any worker may make any call at any time.
class BeggingList {
 public:
  BeggingList(int num_workers, WorkerGroups groups);

  /// False: the list is closed. A worker that is on the list must not be added.
  bool add(WorkerId worker);
  struct Beggar {
    WorkerId worker = kNoWorker;
    std::size_t level = 0;  // of the list that it was on
  };
  /// Takes the beggar off the list that `giver` should serve; kNoWorker: it sees none. The last worker that
  /// does not beg sees one.
  Beggar take_first_for(WorkerId giver);
  /// Puts it back where it was, first of all. The list must not have been closed meanwhile.
  void put_back(const Beggar& beggar);
  /// A hint: whether take_first_for(giver) would name somebody.
  bool may_serve(WorkerId giver) const;
  /// Takes `worker` off, if it is on the list.
  void remove(WorkerId worker);
  /// Nobody is added any more. Returns who was on the list.
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
