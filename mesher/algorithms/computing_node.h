// A computing node of PDR.PODM: a group of workers that are confined to one leaf after the other.
#pragma once

#include <optional>
#include <span>

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

  /// The workers keep to the leaf from now on. None works while this is called, or end().
  void begin(const Octree& octree, LeafId leaf, double now_s);
  /// The leaf ends: new cells of others go to them, cells that need vertices outside its region are deferred.
  /// Returns what happened meanwhile, but for the time, which the caller takes when nobody works there any
  /// more.
  LeafSchedule::Activation end(LeafCells& cells, RefinementQueue& queue, const std::stop_token& stop);
  /// New cells of other leaves that end() will hand over.
  std::size_t num_foreign() const;
  /// Whether each worker is to hand its foreign cells over before it begs. Set while the others beg.
  bool hands_over() const { return hands_over_; }
  void set_hands_over(bool hands_over) { hands_over_ = hands_over; }
  /// Whether a leaf has begun that has not ended.
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

extern template class ComputingNode<LeafLocks<NoLocks>>;
extern template class ComputingNode<LeafLocks<VertexLocks>>;

}  // namespace podm
