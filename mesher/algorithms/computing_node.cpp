#include "algorithms/computing_node.h"

#include <algorithm>

namespace podm {

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

template class ComputingNode<LeafLocks<NoLocks>>;
template class ComputingNode<LeafLocks<VertexLocks>>;

}  // namespace podm
