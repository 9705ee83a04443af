#include "algorithms/leaf_cells.h"

#include <algorithm>
#include <utility>

namespace podm {

LeafCells::LeafCells(const Mesh& mesh, const Octree& octree, const Entries* only)
    : mesh_(mesh),
      octree_(octree),
      only_(only),
      bound_(only != nullptr ? static_cast<CellId>(only->size()) : mesh.cell_bound()),
      outside_((bound_ + std::size_t{kSlice} - 1) / kSlice),
      list_of_leaf_(octree.num_leaves()) {}

LeafCells::Entries LeafCells::living_of(std::size_t slice) const {
  const auto begin = static_cast<CellId>(slice * kSlice);
  const CellId end = begin + std::min(kSlice, bound_ - begin);
  if (only_ != nullptr) return Entries(only_->begin() + begin, only_->begin() + end);
  Entries living;
  living.reserve(kSlice);
  for (CellId c = begin; c < end; ++c)
    if (mesh_.cell(c).is_alive()) living.push_back({c, mesh_.stamp(c)});
  return living;
}

std::size_t LeafCells::distribute(std::size_t slice) {
  const Entries living = living_of(slice);
  for_each_leaf(living, [&](LeafId leaf, std::span<const Key> keys) {
    if (leaf == kNoLeaf) {
      append(living, keys, outside_[slice]);
    } else {
      const std::scoped_lock lock(mutex_of(leaf));
      append(living, keys, list_of_leaf_[leaf].entries);
      list_of_leaf_[leaf].num_distributed += keys.size();
    }
    return true;
  });
  return living.size();
}

void LeafCells::share_out(RefinementQueue& queue, const std::stop_token& stop) const {
  for (LeafId leaf = 0; leaf < list_of_leaf_.size() && !stop.stop_requested(); ++leaf)
    queue.push(leaf, list_of_leaf_[leaf].num_distributed);
  queue.share_out(stop);
}

void LeafCells::add(const Entries& cells, RefinementQueue& queue, const std::stop_token& stop) {
  Entries living;
  std::copy_if(cells.begin(), cells.end(), std::back_inserter(living),
               [&](const auto& entry) { return mesh_.stamp(entry.cell) == entry.stamp; });
  for_each_leaf(living, [&](LeafId leaf, std::span<const Key> keys) {
    if (stop.stop_requested()) return false;
    if (leaf == kNoLeaf) {
      const std::scoped_lock lock(leftover_mutex_);
      append(living, keys, leftover_);
    } else {
      {
        const std::scoped_lock lock(mutex_of(leaf));
        append(living, keys, list_of_leaf_[leaf].entries);
      }
      queue.push(leaf, keys.size());
    }
    return true;
  });
}

std::size_t LeafCells::rename(const Relocation& relocation, std::size_t part, std::size_t num_parts) {
  std::size_t num_cells = 0;
  const auto rename = [&](Entries& cells) {
    num_cells += cells.size();
    for (auto& entry : cells) {
      entry.cell = relocation.cell_now(entry.cell);
      entry.stamp = mesh_.stamp(entry.cell);
    }
  };
  for (std::size_t leaf = part; leaf < list_of_leaf_.size(); leaf += num_parts)
    rename(list_of_leaf_[leaf].entries);
  for (std::size_t slice = part; slice < outside_.size(); slice += num_parts) rename(outside_[slice]);
  return num_cells;
}

void LeafCells::defer(const Entries& cells) {
  const std::scoped_lock lock(leftover_mutex_);
  leftover_.insert(leftover_.end(), cells.begin(), cells.end());
}

LeafCells::Entries LeafCells::take(LeafId leaf) {
  List taken;
  {
    const std::scoped_lock lock(mutex_of(leaf));
    std::swap(taken, list_of_leaf_[leaf]);
  }
  std::sort(taken.entries.begin(), taken.entries.begin() + static_cast<std::ptrdiff_t>(taken.num_distributed),
            [](const auto& a, const auto& b) { return a.cell < b.cell; });
  return std::move(taken.entries);
}

LeafCells::Entries LeafCells::take_leftover() {
  Entries left;
  for (const Entries& of_slice : outside_) left.insert(left.end(), of_slice.begin(), of_slice.end());
  left.insert(left.end(), leftover_.begin(), leftover_.end());
  return left;
}

// Calls action(leaf, keys) by ascending leaf, with kNoLeaf last, until it returns false. The keys of a leaf
// are in the order of the cells.
template <class Action>
void LeafCells::for_each_leaf(const Entries& cells, Action&& action) const {
  std::vector<Key> keys;
  keys.reserve(cells.size());
  for (const auto& entry : cells)
    keys.push_back(Key{octree_.leaf_at(mesh_.cell(entry.cell).center)} << 32 | keys.size());
  std::sort(keys.begin(), keys.end());
  for (auto first = keys.begin(); first != keys.end();) {
    const Key leaf = *first >> 32;
    const auto last = std::find_if(first, keys.end(), [&](Key key) { return key >> 32 != leaf; });
    if (!action(static_cast<LeafId>(leaf), std::span<const Key>(first, last))) return;
    first = last;
  }
}

void LeafCells::append(const Entries& cells, std::span<const Key> keys, Entries& to) {
  for (const Key key : keys) to.push_back(cells[static_cast<std::uint32_t>(key)]);
}

}  // namespace podm
