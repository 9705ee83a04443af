#include "refine/leaf_refinement.h"

#include <algorithm>
#include <map>

namespace podm {

LeafRefinement::LeafRefinement(const Mesh& mesh, const Octree& octree, unsigned num_nodes,
                               const Entries& cells, std::function<double()> clock, std::stop_token over)
    : mesh_(mesh),
      octree_(octree),
      clock_(std::move(clock)),
      over_(std::move(over)),
      queue_(octree, num_nodes),
      cells_of_leaf_(octree.num_leaves()) {
  add(cells);
  queue_.share_out(over_);
}

void LeafRefinement::add(const Entries& cells) {
  std::map<LeafId, std::uint64_t> num_new;
  const std::scoped_lock lock(mutex_);
  for (const auto& entry : cells) {
    if (over_.stop_requested()) return;
    if (mesh_.stamp(entry.cell) != entry.stamp) continue;
    const LeafId leaf = octree_.leaf_at(mesh_.cell(entry.cell).sphere.center);
    (leaf == kNoLeaf ? leftover_ : cells_of_leaf_[leaf]).push_back(entry);
    if (leaf != kNoLeaf) ++num_new[leaf];
  }
  for (const auto& [leaf, count] : num_new) {
    if (over_.stop_requested()) return;
    queue_.push(leaf, count);
  }
}

void LeafRefinement::defer(const Entries& cells) {
  const std::scoped_lock lock(mutex_);
  leftover_.insert(leftover_.end(), cells.begin(), cells.end());
}

std::optional<LeafId> LeafRefinement::take_leaf(unsigned node, bool may_wait) {
  if (over_.stop_requested()) return std::nullopt;
  return may_wait ? queue_.wait_and_pop(node, over_) : queue_.pop(node);
}

LeafRefinement::Entries LeafRefinement::take_cells(LeafId leaf) {
  const std::scoped_lock lock(mutex_);
  return std::exchange(cells_of_leaf_[leaf], {});
}

void LeafRefinement::finish(LeafSchedule::Activation activation) {
  const LeafId leaf = activation.leaf;
  {
    const std::scoped_lock lock(mutex_);
    activation.end_s = clock_();
    schedule_.push_back(std::move(activation));
  }
  queue_.finish(leaf);
}

LeafRefinement::Entries LeafRefinement::take_leftover() { return std::move(leftover_); }

template <class Locks>
std::optional<CellSource::Entries> ComputingNode<Locks>::next(bool may_wait) {
  finish_leaf();
  const auto leaf = shared_.take_leaf(node_, may_wait);
  if (!leaf) return std::nullopt;
  region_.emplace(shared_.octree(), *leaf);
  for (const auto& worker : workers_) worker->locks().confine(*region_);
  const double now = shared_.now();
  activation_ = {*leaf, node_, now, now, num_committed(), 0, {}};
  return shared_.take_cells(*leaf);
}

template <class Locks>
void ComputingNode<Locks>::finish_leaf() {
  if (!region_) return;
  for (const auto& worker : workers_) {
    shared_.add(worker->take_foreign());
    const Entries deferred = worker->take_deferred();
    activation_.deferred += deferred.size();
    shared_.defer(deferred);
    auto& touched = worker->locks().touched_leaves();
    activation_.touched_leaves.insert(activation_.touched_leaves.end(), touched.begin(), touched.end());
    touched.clear();
  }
  auto& touched = activation_.touched_leaves;
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  activation_.operations = num_committed() - activation_.operations;
  region_.reset();
  shared_.finish(std::move(activation_));
}

template <class Locks>
std::uint64_t ComputingNode<Locks>::num_committed() const {
  std::uint64_t committed = 0;
  for (const auto& worker : workers_)
    for (const std::uint64_t insertions : worker->counters().insertions_by_rule) committed += insertions;
  return committed;
}

template class ComputingNode<LeafLocks<NoLocks>>;
template class ComputingNode<LeafLocks<VertexLocks>>;

}  // namespace podm
