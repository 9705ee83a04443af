// How the workers of one group get along: who runs, who waits after a conflict, who begs and is given cells.
// What a worker does after an attempt is decided here alone; time, real or virtual, does the blocking.
//
// One mutex guards it all. It is taken on conflicts, when cells run out or are given, and after every 10
// successes while somebody waits: not by operations that succeed alone.
#pragma once

#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "refine/outcome.h"
#include "refine/poor_element_list.h"
#include "workers/activity.h"
#include "workers/begging_list.h"
#include "workers/contention_manager.h"

namespace podm {

/// How many workers run, and how they get out of each other's way.
struct CoordinationOptions {
  int num_workers = 1;
  Contention contention = Contention::kLocal;
  WorkerGroups groups;  // of the begging list
  std::uint64_t seed = 1;
};

/// Of the workers from `first_id` on, as locks name them. The first is the master, to whom the others' end is
/// told. Any worker may call for itself at any time.
class Coordination {
 public:
  using Entries = std::vector<PoorElementList::Entry>;
  using Answer = ContentionManager::Answer;

  /// `resume(worker)` is called for each worker that was blocked and runs again.
  Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume,
               WorkerId first_id = 0);

  /// What `self` does after an attempt, whose locks are released. A conflict: after kWait it must block,
  /// after kPause sleep; nobody waits for a worker of another group. A success may wake a worker, and share
  /// cells.
  template <class Worker>
  Answer after(Outcome outcome, WorkerId self, Worker& worker) {
    const WorkerId number = self - first_id_;
    if (outcome == Outcome::kLockConflict) return conflict(number, worker.conflicting_worker() - first_id_);
    if (outcome != Outcome::kCommitted && outcome != Outcome::kSound) return {};
    if (is_due_to_wake(number)) wake_one(number);
    if (may_share(number, worker.num_listed())) share(number, worker);
    return {};
  }

  /// `self` has no cells left. True: it must block, and then take its gift, which may be empty. False: no
  /// worker has any, and it is the master; or the master has dismissed it.
  bool beg(WorkerId self);
  Entries take_gift(WorkerId self);
  /// By the master, when beg() has told it that no worker has cells, and there will be no more.
  void dismiss();

 private:
  // A worker shares when it lists this many cells or more; most are dead, as their turn tells.
  static constexpr std::size_t kEnoughToShare = 64, kMostToShare = 1024;
  static constexpr WorkerId kMaster = 0;

  // Of one worker, which alone counts, in a cache line of its own.
  struct alignas(64) Streak {
    int conflicts = 0, successes = 0;  // in a row
  };

  // All below number workers from 0 on.
  Answer conflict(WorkerId self, WorkerId holder);
  bool is_due_to_wake(WorkerId self) {
    streaks_[self].conflicts = 0;
    return ++streaks_[self].successes % ContentionManager::kSuccessesToWake == 0 && contention_.has_waiting();
  }
  void wake_one(WorkerId self);
  // A hint: somebody begs whom `giver`, which lists so many cells, could serve.
  bool may_share(WorkerId giver, std::size_t num_listed) const {
    return num_listed >= kEnoughToShare && begging_.may_serve(giver);
  }
  template <class Worker>
  void share(WorkerId giver, Worker& worker) {
    const std::scoped_lock lock(mutex_);
    const WorkerId beggar = begging_.first_for(giver);
    if (beggar == kNoWorker) return;
    Entries cells = worker.share(kMostToShare);
    if (cells.empty()) return;
    gifts_[beggar] = std::move(cells);
    end_begging(beggar);
  }
  void end_begging(WorkerId beggar);
  void resume(WorkerId worker);

  std::mutex mutex_;
  Activity activity_;
  ContentionManager contention_;
  BeggingList begging_;
  std::vector<Entries> gifts_;
  bool is_dismissed_ = false;
  std::vector<Streak> streaks_;
  std::function<void(WorkerId)> resume_;
  WorkerId first_id_;
};

}  // namespace podm
