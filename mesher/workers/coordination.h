// How the workers of one group get along: who runs, who waits after a conflict, who begs and is given cells.
// What a worker does after an attempt is decided here alone; time, real or virtual, does the blocking.
//
// Workers meet at locks of single workers and of begging lists, and count those who beg: an operation that
// succeeds alone touches none of them. Where each use of a lock is charged 0.5 us, one after the other, the
// refinement of 0.5 million cells by 256 virtual workers takes 1.05 times as long; with one lock for all it
// took 2.4 times as long.
//
// A worker counts for one from when it is on a begging list and has counted itself. Whoever takes it off the
// list counts it down once its gift is there, and is not counted until then. So when all are counted, each is
// on a list: none runs, none has a gift, and none waits, for whoever waits, waits for one that runs
// (workers/contention_manager.h).
//
// Cells that are sent to a home wait there. Who begs looks for them first, and goes on a list under the lock
// of its home only if there are none. Who sends puts them there under that lock, and then serves those of the
// home who beg, and maybe others whom these lists hold, until none does or none are left. So whoever of the
// home was on a list before they came is served, or served by another; whoever comes later finds them. Who
// takes a beggar off a list and puts it back, serves its home then, as a sender may have missed it. When all
// are counted, and so nobody sends any more, no home has cells. No cells are left.
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

/// How many workers run, and how they get out of each other's way.
struct CoordinationOptions {
  int num_workers = 1;
  Contention contention = Contention::kLocal;
  WorkerGroups groups = {};  // as the begging list needs them
  // Workers i with equal i / workers_per_home have a home together; 0: none has one.
  int workers_per_home = 0;
  std::uint64_t seed = 1;
};

/// It coordinates the workers from `first_id` on, as locks name them. The first is the master, to whom the
/// others' end is told. Any worker may call for itself at any time.
class Coordination {
 public:
  using Entries = std::vector<PoorElementList::Entry>;
  using Answer = ContentionManager::Answer;

  /// `resume(worker)` is called for each worker that was blocked and runs again.
  Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume,
               WorkerId first_id = 0);

  /// What `self` does after an attempt, whose locks are released. After a conflict it must block (kWait) or
  /// sleep (kPause), or may try on; nobody waits for a worker of another group. A success may wake a worker,
  /// and share cells.
  template <class Worker>
  Answer after(Outcome outcome, WorkerId self, Worker& worker) {
    const WorkerId number = self - first_id_;
    if (outcome == Outcome::kLockConflict) return conflict(number, worker.conflicting_worker() - first_id_);
    if (outcome != Outcome::kCommitted && outcome != Outcome::kSound) return {};
    if (is_due_to_wake(number)) wake_one(number);
    if (may_share(number, worker.num_listed())) share(number, worker);
    return {};
  }

  /// Cells for the workers of a home. The caller runs.
  void send(unsigned home, const Entries& cells);
  enum class Begging {
    kListed,   // it must block, and then take its gift, which may be empty
    kHasGift,  // it may take that at once
    kOver      // no worker has cells, and it is the master; or the master has dismissed it
  };
  /// `self` has no cells left.
  Begging beg(WorkerId self);
  Entries take_gift(WorkerId self);
  /// Gives an empty gift to each who begs. `self` does not.
  void rouse(WorkerId self);
  /// Called by the master, when beg() has told it that no worker has cells, and there will be no more.
  void dismiss();

 private:
  // A worker shares when it lists this many cells or more; most are dead, as their turn tells.
  static constexpr std::size_t kEnoughToShare = 64, kMostToShare = 1024;
  static constexpr WorkerId kMaster = 0;

  // What belongs to one worker, in cache lines of its own.
  struct alignas(128) Member {
    int conflicts = 0, successes = 0;  // in a row, as the worker alone counts them
    std::mutex mutex;                  // guards the gift
    Entries gift;
  };

  struct alignas(128) Home {
    std::mutex mutex;
    Entries cells;
  };

  // All below number workers from 0 on.
  Answer conflict(WorkerId self, WorkerId holder);
  bool is_due_to_wake(WorkerId self) {
    Member& member = members_[self];
    member.conflicts = 0;
    return ++member.successes % ContentionManager::kSuccessesToWake == 0 && contention_.may_wake(self);
  }
  void wake_one(WorkerId self);
  // A hint whether somebody begs whom `giver`, which lists so many cells, could serve.
  bool may_share(WorkerId giver, std::size_t num_listed) const {
    return num_begging_.load(std::memory_order_relaxed) > 0 && num_listed >= kEnoughToShare &&
           begging_.may_serve(giver);
  }
  template <class Worker>
  void share(WorkerId giver, Worker& worker) {
    const BeggingList::Beggar beggar = begging_.take_first_for(giver);
    if (beggar.worker == kNoWorker) return;  // another giver was quicker
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
