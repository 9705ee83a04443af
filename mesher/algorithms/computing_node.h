// A computing node of PDR.PODM: a group of workers that is confined to one leaf after the other.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "algorithms/leaf_cells.h"
#include "algorithms/leaf_locks.h"
#include "octree/leaf_region.h"
#include "podm/meshing_report.h"
#include "refine/worker.h"
#include "workers/coordination.h"

namespace podm {

template <class Locks>
class ComputingNode {
 public:
  using Workers = std::span<const std::unique_ptr<Worker<Locks>>>;

  ComputingNode(unsigned number, Workers workers, const CoordinationOptions& options,
                std::function<void(WorkerId)> resume)
      : number_(number), workers_(workers), group_(options, std::move(resume), workers.front()->id()) {}

  unsigned number() const { return number_; }
  std::size_t num_workers() const { return workers_.size(); }
  Worker<Locks>& master() const { return *workers_.front(); }
  Coordination& group() { return group_; }

  /// Confines the workers to the leaf from now on. No worker may work during this call or end().
  void begin(const Octree& octree, LeafId leaf, double now_s);
  /// Ends the leaf: hands new cells of other leaves over to them, and defers cells that need vertices outside
  /// the leaf's region. Returns the activation without its end time, which the caller adds once no worker
  /// works there any more.
  LeafSchedule::Activation end(LeafCells& cells, RefinementQueue& queue, const std::stop_token& stop);
  /// The number of new cells of other leaves that end() will hand over.
  std::size_t num_foreign() const;
  /// True if each worker is to hand its foreign cells over before it begs. Set while all workers but the
  /// master beg.
  bool hands_over() const { return hands_over_; }
  void set_hands_over(bool hands_over) { hands_over_ = hands_over; }
  /// True between begin() and end().
  bool has_leaf() const { return region_.has_value(); }
  LeafId leaf() const { return region_->leaf(); }

 private:
  std::uint64_t num_committed() const;

  unsigned number_;
  Workers workers_;
  Coordination group_;
  std::optional<LeafRegion> region_;
  bool hands_over_ = false;
  LeafSchedule::Activation activation_{};
};

template <class Locks>
void ComputingNode<Locks>::begin(const Octree& octree, LeafId leaf, double now_s) {
  region_.emplace(octree, leaf);
  for (const auto& worker : workers_) worker->locks().confine(*region_);
  activation_ = {.leaf = leaf,
                 .node = number_,
                 .begin_s = now_s,
                 .end_s = now_s,
                 .operations = num_committed(),
                 .deferred = 0,
                 .touched_leaves = {}};
}

template <class Locks>
LeafSchedule::Activation ComputingNode<Locks>::end(LeafCells& cells, RefinementQueue& queue,
                                                   const std::stop_token& stop) {
  std::vector<LeafId>& touched = activation_.touched_leaves;
  for (const auto& worker : workers_) {
    cells.add(worker->take_foreign(), queue, stop);
    const LeafCells::Entries deferred = worker->take_deferred();
    activation_.deferred += deferred.size();
    cells.defer(deferred);
    const std::vector<LeafId> of_worker = std::exchange(worker->locks().touched_leaves(), {});
    touched.insert(touched.end(), of_worker.begin(), of_worker.end());
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  activation_.operations = num_committed() - activation_.operations;
  region_.reset();
  return std::move(activation_);
}

template <class Locks>
std::size_t ComputingNode<Locks>::num_foreign() const {
  std::size_t num_foreign = 0;
  for (const auto& worker : workers_) num_foreign += worker->num_foreign();
  return num_foreign;
}

template <class Locks>
std::uint64_t ComputingNode<Locks>::num_committed() const {
  std::uint64_t committed = 0;
  for (const auto& worker : workers_) committed += worker->counters().num_insertions();
  return committed;
}

}  // namespace podm
