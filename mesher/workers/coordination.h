// Coordination of the workers of one group: which ones run, which wait after a conflict, which beg and are
// given cells. Only this class decides what a worker does after an attempt. Time, real or virtual, does the
// blocking.
//
// Workers synchronize through locks of single workers, through locks of begging lists and through a count of
// begging workers. An operation that succeeds, and neither wakes a worker nor shares cells, takes no lock. If
// uses of a lock are serialized and each is charged 0.5 us, the refinement of 0.5 million cells by 256
// virtual workers takes 1.05 times as long. With one lock for all it took 2.4 times as long.
//
// A worker counts as begging once it is on a begging list and has counted itself. A worker that takes it off
// the list decrements the count once the gift is in place, and is not counted itself until then. When all
// workers are counted, each is therefore on a list: none runs, none has a gift, and none waits, because each
// worker that waits, waits for one that runs (workers/contention_manager.h).
//
// Cells that are sent to a home wait there. A worker that begs looks for them first, and joins a list, under
// the lock of its home, only if there are none. A sender adds cells under that lock. It then serves begging
// workers of the home, and maybe others on the same lists, until none begs or no cells are left. A worker of
// the home that was on a list before the cells came is therefore served, by the sender or by another worker.
// A worker that begs later finds the cells. A worker that takes a beggar off a list and puts it back then
// serves the beggar's home, because a sender may have missed the beggar. When all workers are counted, none
// sends any more, so no home has cells. No cells are left.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "refine/outcome.h"
#include "refine/poor_element_list.h"
#include "workers/begging_list.h"
#include "workers/contention_manager.h"

namespace podm {

/// The number of workers in a group, and how they avoid each other.
struct CoordinationOptions {
  int num_workers = 1;
  Contention contention = Contention::kLocal;
  WorkerGroups groups = {};  // as the begging list requires them
  // Workers i with equal i / workers_per_home have a home in common; 0: there are no homes.
  int workers_per_home = 0;
  std::uint64_t seed = 1;
};

/// Coordinates the workers with ids from `first_id` on, as the locks use them. The first worker is the
/// master, which learns when no worker has cells. Any worker may make any call for itself at any time.
class Coordination {
 public:
  using Entries = std::vector<PoorElementList::Entry>;
  using Answer = ContentionManager::Answer;

  /// Calls `resume(worker)` for each worker that was blocked and runs again.
  Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume,
               WorkerId first_id = 0);

  /// Decides what `self` does after an attempt, whose locks are released. After a lock conflict the worker
  /// must block (kWait) or sleep (kPause), or may try again. No worker waits for a worker of another group.
  /// After a success the worker may wake another one and share cells.
  template <class Worker>
  Answer after(Outcome outcome, WorkerId self, Worker& worker) {
    const WorkerId number = self - first_id_;
    if (outcome == Outcome::kLockConflict) return conflict(number, worker.conflicting_worker() - first_id_);
    if (outcome != Outcome::kCommitted && outcome != Outcome::kSound) return {};
    if (is_due_to_wake(number)) wake_one(number);
    if (may_share(number, worker.num_listed())) share(number, worker);
    return {};
  }

  /// Sends cells to the workers of a home. The calling worker must run: it neither waits nor begs.
  void send(unsigned home, const Entries& cells);
  enum class Begging {
    kListed,   // the worker must block and then take its gift, which may be empty
    kHasGift,  // the worker may take its gift at once
    kOver      // no worker has cells, and the worker is the master; or the master has dismissed it
  };
  /// `self` has no cells left.
  Begging beg(WorkerId self);
  Entries take_gift(WorkerId self);
  /// Gives an empty gift to each begging worker. `self` does not beg.
  void wake_beggars(WorkerId self);
  /// Called by the master when beg() has returned kOver to it and there will be no more cells.
  void dismiss();

 private:
  // A worker shares when it lists at least kEnoughToShare cells. Most of them are dead, which shows when
  // their turn comes.
  static constexpr std::size_t kEnoughToShare = 64, kMostToShare = 1024;
  static constexpr WorkerId kMaster = 0;

  // Data of one worker, in cache lines of its own.
  struct alignas(128) Member {
    int conflicts = 0, successes = 0;  // in a row; only the worker itself counts them
    std::mutex mutex;                  // guards the gift
    Entries gift;
  };

  struct alignas(128) Home {
    std::mutex mutex;
    Entries cells;
  };

  // All functions below number workers from 0 on.
  Answer conflict(WorkerId self, WorkerId holder);
  bool is_due_to_wake(WorkerId self) {
    Member& member = members_[self];
    member.conflicts = 0;
    return ++member.successes % ContentionManager::kSuccessesToWake == 0 && contention_.may_wake(self);
  }
  void wake_one(WorkerId self);
  // A hint: true if a worker begs that `giver`, which lists `num_listed` cells, could serve.
  bool may_share(WorkerId giver, std::size_t num_listed) const {
    return num_begging_.load(std::memory_order_relaxed) > 0 && num_listed >= kEnoughToShare &&
           begging_.may_serve(giver);
  }
  template <class Worker>
  void share(WorkerId giver, Worker& worker) {
    const BeggingList::Beggar beggar = begging_.take_first_for(giver);
    if (beggar.worker == kNoWorker) return;  // another giver was faster
    Entries cells = worker.share(kMostToShare);
    if (cells.empty()) {
      begging_.put_back(beggar);
      if (!homes_.empty()) serve(beggar.worker / workers_per_home_);  // cells may have come meanwhile
    } else {
      give(beggar.worker, std::move(cells));
    }
  }
  Begging look_home_or_join(WorkerId self);
  void serve(unsigned home);
  static bool has_cells(Home& home);
  static Entries take_from(Home& home);
  void give(WorkerId beggar, Entries cells);
  void end_begging(WorkerId beggar);
  void resume(WorkerId worker) { resume_(first_id_ + worker); }

  ContentionManager contention_;
  BeggingList begging_;
  std::vector<Member> members_;
  WorkerId workers_per_home_;
  std::vector<Home> homes_;
  std::atomic<int> num_begging_ = 0;
  std::function<void(WorkerId)> resume_;
  WorkerId first_id_;
};

}  // namespace podm
