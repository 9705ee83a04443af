// The poor cells of leaves. A cell belongs to the leaf that has its circumcentre.
#pragma once

#include <mutex>
#include <stop_token>
#include <vector>

#include "octree/refinement_queue.h"
#include "refine/poor_element_list.h"

namespace podm {

/// Any thread may call any of it; it takes its one lock when a leaf begins or ends.
class LeafCells {
 public:
  using Entries = std::vector<PoorElementList::Entry>;

  LeafCells(const Mesh& mesh, const Octree& octree)
      : mesh_(mesh), octree_(octree), cells_of_leaf_(octree.num_leaves()) {}

  /// Lists cells with their leaves, and tells the queue. Nobody may change them meanwhile. After a stop
  /// request it lists no more.
  void add(const Entries& cells, RefinementQueue& queue, const std::stop_token& stop);
  /// Lists cells that no leaf can refine.
  void defer(const Entries& cells);
  Entries take(LeafId leaf);
  /// Deferred cells and those that are in no leaf.
  Entries take_leftover();

 private:
  const Mesh& mesh_;
  const Octree& octree_;
  std::mutex mutex_;  // guards what follows
  std::vector<Entries> cells_of_leaf_;
  Entries leftover_;
};

}  // namespace podm
