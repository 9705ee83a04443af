#include "algorithms/leaf_cells.h"

#include <map>
#include <utility>

namespace podm {

void LeafCells::add(const Entries& cells, RefinementQueue& queue, const std::stop_token& stop) {
  std::map<LeafId, std::uint64_t> num_new;
  const std::scoped_lock lock(mutex_);
  for (const auto& entry : cells) {
    if (stop.stop_requested()) return;
    if (mesh_.stamp(entry.cell) != entry.stamp) continue;
    const LeafId leaf = octree_.leaf_at(mesh_.cell(entry.cell).center);
    (leaf == kNoLeaf ? leftover_ : cells_of_leaf_[leaf]).push_back(entry);
    if (leaf != kNoLeaf) ++num_new[leaf];
  }
  for (const auto& [leaf, count] : num_new) {
    if (stop.stop_requested()) return;
    queue.push(leaf, count);
  }
}

void LeafCells::defer(const Entries& cells) {
  const std::scoped_lock lock(mutex_);
  leftover_.insert(leftover_.end(), cells.begin(), cells.end());
}

LeafCells::Entries LeafCells::take(LeafId leaf) {
  const std::scoped_lock lock(mutex_);
  return std::exchange(cells_of_leaf_[leaf], {});
}

LeafCells::Entries LeafCells::take_leftover() { return std::move(leftover_); }

}  // namespace podm
