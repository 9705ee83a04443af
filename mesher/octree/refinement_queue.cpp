#include "octree/refinement_queue.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace podm {

RefinementQueue::RefinementQueue(const Octree& octree, unsigned num_nodes, LeafOrder order)
    : octree_(octree),
      order_(order),
      num_poor_(octree.num_leaves()),
      num_active_near_(octree.num_leaves()),
      share_of_(octree.num_leaves()),
      ready_(order == LeafOrder::kHome ? num_nodes : 1),
      resume_at_(num_nodes) {
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf)
    share_of_[leaf] = leaf * ready_.size() / octree.num_leaves();
  if (order_ != LeafOrder::kMorton) return;
  for (unsigned node = 0; node < num_nodes; ++node)
    resume_at_[node] = std::uint64_t{octree.num_leaves()} * node / num_nodes;
}

void RefinementQueue::share_out() {
  const std::lock_guard lock(mutex_);
  const std::uint64_t total = std::reduce(num_poor_.begin(), num_poor_.end());
  for (auto& ready : ready_) ready.clear();
  std::uint64_t before = 0;
  for (LeafId leaf = 0; leaf < octree_.num_leaves(); ++leaf) {
    if (total > 0) share_of_[leaf] = std::min(before * ready_.size() / total, ready_.size() - 1);
    before += num_poor_[leaf];
    if (is_ready(leaf)) ready_of(leaf).insert(key(leaf));
  }
}

void RefinementQueue::push(LeafId leaf, std::uint64_t num_poor) {
  if (num_poor == 0) return;
  const std::lock_guard lock(mutex_);
  if (is_ready(leaf)) ready_of(leaf).erase(key(leaf));
  if (num_poor_[leaf] == 0) ++counts_.pending;
  num_poor_[leaf] += num_poor;
  if (!is_ready(leaf)) return;
  ready_of(leaf).insert(key(leaf));
  changed_.notify_all();
}

std::optional<LeafId> RefinementQueue::pop(unsigned node) {
  const std::lock_guard lock(mutex_);
  return take(node);
}

std::optional<LeafId> RefinementQueue::wait_and_pop(unsigned node, std::stop_token stop) {
  std::unique_lock lock(mutex_);
  std::optional<LeafId> leaf;
  ++counts_.waiting;
  changed_.wait(lock, stop, [&] {
    if (!stop.stop_requested()) leaf = take(node);
    return leaf || counts_.pending + counts_.active == 0;
  });
  --counts_.waiting;
  return leaf;
}

void RefinementQueue::finish(LeafId leaf) {
  const std::vector<LeafId> zones = buffer_zones(leaf);
  const std::lock_guard lock(mutex_);
  set_active(zones, false);
  changed_.notify_all();
}

RefinementQueue::Counts RefinementQueue::counts() const {
  const std::lock_guard lock(mutex_);
  Counts counts = counts_;
  for (const auto& ready : ready_) counts.ready += ready.size();
  return counts;
}

const std::set<RefinementQueue::Key>& RefinementQueue::ready_for(unsigned node) const {
  if (order_ == LeafOrder::kHome && !ready_[node].empty()) return ready_[node];
  return *std::max_element(ready_.begin(), ready_.end(),
                           [](const auto& a, const auto& b) { return a.size() < b.size(); });
}

RefinementQueue::Key RefinementQueue::key(LeafId leaf) const {
  const auto rank = [&]() -> std::uint64_t {
    const GridCube& cube = octree_.cube(leaf);
    const auto position = [&](unsigned axis) { return cube.corner[axis] / cube.side % 3; };
    switch (order_) {
      case LeafOrder::kMorton:
        return 0;
      case LeafOrder::kColoring:
        return position(0) + 3 * position(1) + 9 * position(2);
      case LeafOrder::kHome:
      case LeafOrder::kMostWork:
        break;
    }
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    return kMost - std::min(num_poor_[leaf], kMost);
  };
  return rank() << 32 | leaf;
}

// L, B1 and B2.
std::vector<LeafId> RefinementQueue::buffer_zones(LeafId leaf) const {
  std::vector<LeafId> zones = octree_.second_ring(leaf);
  const std::vector<LeafId> first = octree_.first_ring(leaf);
  zones.insert(zones.end(), first.begin(), first.end());
  zones.push_back(leaf);
  return zones;
}

void RefinementQueue::set_active(const std::vector<LeafId>& zones, bool is_active) {
  for (const LeafId near : zones) {
    const bool was_ready = is_ready(near);
    is_active ? ++num_active_near_[near] : --num_active_near_[near];
    if (was_ready && !is_ready(near)) ready_of(near).erase(key(near));
    if (!was_ready && is_ready(near)) ready_of(near).insert(key(near));
  }
  is_active ? ++counts_.active : --counts_.active;
}

std::optional<LeafId> RefinementQueue::take(unsigned node) {
  const std::set<Key>& ready = ready_for(node);
  if (ready.empty()) return std::nullopt;
  Key& resume_at = resume_at_[order_ == LeafOrder::kMorton ? node : 0];
  const auto next = ready.lower_bound(resume_at);
  const Key taken = next != ready.end() ? *next : *ready.begin();
  if (order_ == LeafOrder::kMorton || order_ == LeafOrder::kColoring) resume_at = taken;
  const auto leaf = static_cast<LeafId>(taken);
  set_active(buffer_zones(leaf), true);
  num_poor_[leaf] = 0;
  --counts_.pending;
  return leaf;
}

}  // namespace podm
