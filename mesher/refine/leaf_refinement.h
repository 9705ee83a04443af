// Refinement leaf by leaf: poor cells wait in the list of the leaf that has their circumcentre. A computing
// node takes a leaf from the queue, refines its cells, sends new cells of other leaves to theirs, and returns
// the leaf. (Feng et al., IMR 2015, Fig. 3.)
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "octree/refinement_queue.h"
#include "podm/mesh_image.h"
#include "refine/coordination.h"
#include "refine/worker.h"

namespace podm {

/// What the computing nodes share: the cells of each leaf, and the queue.
class LeafRefinement {
 public:
  using Entries = CellSource::Entries;

  /// Of `cells`, to begin with. `clock` gives seconds, for the schedule; `over` ends waiting and listing.
  LeafRefinement(const Mesh& mesh, const Octree& octree, unsigned num_nodes, const Entries& cells,
                 std::function<double()> clock, std::stop_token over);

  /// Lists cells with their leaves. Nobody may change them meanwhile.
  void add(const Entries& cells);
  /// Lists cells that no leaf can refine.
  void defer(const Entries& cells);
  std::optional<LeafId> take_leaf(unsigned node, bool may_wait);
  Entries take_cells(LeafId leaf);
  void finish(LeafSchedule::Activation activation);

  /// Deferred cells and those that are in no leaf.
  Entries take_leftover();
  std::vector<LeafSchedule::Activation> take_schedule() { return std::move(schedule_); }
  const Octree& octree() const { return octree_; }
  double now() const { return clock_(); }

 private:
  const Mesh& mesh_;
  const Octree& octree_;
  std::function<double()> clock_;
  std::stop_token over_;
  RefinementQueue queue_;
  std::mutex mutex_;  // guards what follows; taken when a leaf begins or ends
  std::vector<Entries> cells_of_leaf_;
  Entries leftover_;
  std::vector<LeafSchedule::Activation> schedule_;
};

/// One group of workers that refines leaf after leaf.
template <class Locks>
class ComputingNode : public CellSource {
 public:
  using Workers = std::span<const std::unique_ptr<Worker<Locks>>>;

  ComputingNode(LeafRefinement& shared, unsigned node, Workers workers)
      : shared_(shared), node_(node), workers_(workers) {}
  Workers workers() const { return workers_; }
  std::optional<Entries> next(bool may_wait) override;
  /// Ends the leaf at hand, if there is one. No worker runs.
  void finish_leaf();

 private:
  std::uint64_t num_committed() const;

  LeafRefinement& shared_;
  unsigned node_;
  Workers workers_;
  std::optional<LeafRegion> region_;
  LeafSchedule::Activation activation_{};
};

extern template class ComputingNode<LeafLocks<NoLocks>>;
extern template class ComputingNode<LeafLocks<VertexLocks>>;

}  // namespace podm
