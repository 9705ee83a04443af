// The begging list: idle workers ask here for cells; a busy worker that has enough gives some to the first it
// serves. Givers push; nobody takes from another's list.
//   random        one list for all, first come first served
//   hierarchical  a giver serves a beggar of its own group first (workers that share a socket or NUMA node)
// Its caller makes sure that one call is made at a time, but for is_empty().
#pragma once

#include <algorithm>
#include <atomic>
#include <vector>

#include "delaunay/vertex_locks.h"
#include "podm/mesh_image.h"

namespace podm {

class BeggingList {
 public:
  /// `group_of[worker]`; one group for all makes the list random.
  explicit BeggingList(std::vector<int> group_of) : group_of_(std::move(group_of)) {}

  void add(WorkerId worker) {
    beggars_.push_back(worker);
    // Relaxed: only a hint; what counts is looked up again by the callers of take_first.
    size_.store(beggars_.size(), std::memory_order_relaxed);
  }
  /// The beggar that `giver` serves; kNoWorker: nobody begs.
  WorkerId take_first(WorkerId giver) {
    if (beggars_.empty()) return kNoWorker;
    auto served = std::find_if(beggars_.begin(), beggars_.end(),
                               [&](WorkerId beggar) { return group_of_[beggar] == group_of_[giver]; });
    if (served == beggars_.end()) served = beggars_.begin();
    const WorkerId worker = *served;
    beggars_.erase(served);
    size_.store(beggars_.size(), std::memory_order_relaxed);
    return worker;
  }
  bool is_empty() const { return size_.load(std::memory_order_relaxed) == 0; }

 private:
  std::vector<int> group_of_;
  std::vector<WorkerId> beggars_;
  std::atomic<std::size_t> size_ = 0;
};

}  // namespace podm
