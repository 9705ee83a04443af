// Locks confined to the region of one leaf of an octree: a vertex outside the region cannot be locked.
// Regions of leaves that are refined at the same time are disjoint (octree/octree.h), so workers of different
// leaves never meet. The argument for two or three locked vertices of a cell (vertex_locks.h) therefore holds
// for two or three vertices in the region. Within one leaf `Inner` locks. With NoLocks a leaf has one worker,
// as in PDR. A horizon of `Inner` is respected, too.
#pragma once

#include <algorithm>
#include <vector>

#include "delaunay/operation.h"
#include "delaunay/vertex_locks.h"
#include "octree/leaf_region.h"
#include "refine/worker.h"

namespace podm {

template <class Inner>
class LeafLocks {
 public:
  static constexpr bool kIsShared = true;
  explicit LeafLocks(WorkerId self) : inner_(self) {}

  /// No lock may be held. The region must outlive the operations.
  void confine(const LeafRegion& region) { region_ = &region; }
  const LeafRegion& region() const { return *region_; }
  Inner& inner() { return inner_; }
  /// From now on records the leaves that contain locked vertices.
  void record_leaves() { is_recording_ = true; }
  std::vector<LeafId>& touched_leaves() { return touched_leaves_; }

  StepResult try_lock(Vertex& v) {
    const Point p = peek_point(v);
    if (!region_->contains(p)) return StepResult::kOutOfReach;
    if (is_recording_) remember(region_->octree().leaf_at(p));
    return inner_.try_lock(v);
  }
  bool holds(const Vertex& v) const { return region_->contains(peek_point(v)) && inner_.holds(v); }
  void unlock_all() { inner_.unlock_all(); }
  WorkerId conflicting_worker() const { return inner_.conflicting_worker(); }

  bool knows(const Cell& cell) const requires HasHorizon<Inner> { return inner_.knows(cell); }
  bool may_read(const Mesh& mesh, const Cell& cell) const requires HasHorizon<Inner> {
    return inner_.may_read(mesh, cell);
  }
  void begin_around(const Point& p) requires HasHorizon<Inner> { inner_.begin_around(p); }
  bool may_replace(const Mesh& mesh, const Cell& cell) const requires HasHorizon<Inner> {
    return inner_.may_replace(mesh, cell);
  }
  bool may_insert(const Point& p, const Cell& cell) const requires HasHorizon<Inner> {
    return inner_.may_insert(p, cell);
  }

 private:
  void remember(LeafId leaf) {
    if (leaf != kNoLeaf &&
        std::find(touched_leaves_.begin(), touched_leaves_.end(), leaf) == touched_leaves_.end())
      touched_leaves_.push_back(leaf);
  }

  Inner inner_;
  const LeafRegion* region_ = nullptr;
  bool is_recording_ = false;
  std::vector<LeafId> touched_leaves_;
};

extern template class Operation<LeafLocks<NoLocks>>;
extern template class Operation<LeafLocks<VertexLocks>>;
extern template class Worker<LeafLocks<NoLocks>>;
extern template class Worker<LeafLocks<VertexLocks>>;

}  // namespace podm
