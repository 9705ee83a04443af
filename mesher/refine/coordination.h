// How the workers of one group get along: who runs, who waits after a conflict, who begs and is given cells.
// Both executors ask here and do the blocking, in real or in virtual time.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "refine/activity.h"
#include "refine/begging_list.h"
#include "refine/contention_manager.h"
#include "refine/poor_element_list.h"

namespace podm {

/// How many workers run, and how they get out of each other's way.
struct CoordinationOptions {
  int num_workers = 1;
  Contention contention = Contention::kLocal;
  WorkerGroups groups;  // of the begging list
  std::uint64_t seed = 1;
};

/// Where a group of workers gets cells when all of them beg: the next leaf, in PDR.
class CellSource {
 public:
  using Entries = std::vector<PoorElementList::Entry>;
  virtual ~CellSource() = default;
  /// Cells to go on with; nothing when there are none: for ever if it `may_wait`, else for now. No worker of
  /// the group runs meanwhile.
  virtual std::optional<Entries> next(bool may_wait) = 0;
};

/// Its caller makes sure that one call is made at a time, but for has_waiting() and may_share().
class Coordination {
 public:
  using Entries = std::vector<PoorElementList::Entry>;

  /// `resume(worker)` is called for each worker that waited or begged and runs again.
  Coordination(const CoordinationOptions& options, std::function<void(WorkerId)> resume);

  bool is_running(WorkerId worker) const { return activity_.of(worker) == Activity::State::kRunning; }
  int num_running() const { return activity_.num_running(); }

  /// `self` met a vertex of `holder`, for the `in_a_row`-th time. After kWait it must not run until resumed.
  /// Nobody waits for a worker of another group.
  ContentionManager::Answer conflict(WorkerId self, WorkerId holder, int in_a_row);
  /// A hint that anyone may ask for at any time.
  bool has_waiting() const { return contention_.has_waiting(); }
  /// After ContentionManager::kSuccessesToWake successes in a row.
  void wake_one(WorkerId self);

  /// `self` has no cells left and must not run until resumed, then to take its gift. False: nobody runs any
  /// more.
  bool beg(WorkerId self);
  /// A hint that anyone may ask for at any time: somebody begs whom `giver`, which lists that many cells,
  /// could serve.
  bool may_share(WorkerId giver, std::size_t num_listed) const {
    return num_listed >= kEnoughToShare && begging_.may_serve(giver);
  }
  template <class Worker>
  void share(WorkerId giver, Worker& worker) {
    const WorkerId beggar = begging_.first_for(giver);
    if (beggar == kNoWorker) return;
    Entries cells = worker.share(kMostToShare);
    if (!cells.empty()) give(beggar, std::move(cells));
  }
  /// Ends the begging of one worker by these cells.
  void give(WorkerId beggar, Entries cells);
  Entries take_gift(WorkerId self) { return std::exchange(gifts_[self], {}); }

 private:
  // A worker shares when it lists this many cells or more; most are dead, as their turn tells.
  static constexpr std::size_t kEnoughToShare = 64, kMostToShare = 1024;
  void resume(WorkerId worker);

  Activity activity_;
  ContentionManager contention_;
  BeggingList begging_;
  std::vector<Entries> gifts_;
  std::function<void(WorkerId)> resume_;
};

}  // namespace podm
