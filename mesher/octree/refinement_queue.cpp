#include "octree/refinement_queue.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

namespace podm {

RefinementQueue::RefinementQueue(const Octree& octree, unsigned num_nodes, LeafOrder order,
                                 std::function<void(unsigned)> wake)
    : octree_(octree),
      order_(order),
      wake_(std::move(wake)),
      is_waiting_(num_nodes),
      node_of_active_(octree.num_leaves()),
      num_poor_(octree.num_leaves()),
      num_active_near_(octree.num_leaves()),
      share_of_(octree.num_leaves()),
      num_rivals_(octree.num_leaves()),
      num_poor_of_share_(order == LeafOrder::kHome ? num_nodes : 1),
      ready_(num_poor_of_share_.size()),
      resume_at_(num_nodes) {
  if (order_ != LeafOrder::kMorton) return;
  for (unsigned node = 0; node < num_nodes; ++node)
    resume_at_[node] = std::uint64_t{octree.num_leaves()} * node / num_nodes;
}

void RefinementQueue::share_out(const std::stop_token& stop) {
  const std::lock_guard lock(mutex_);
  std::vector<LeafId> leaves(octree_.num_leaves());
  std::iota(leaves.begin(), leaves.end(), 0);
  divide(leaves, 0, ready_.size(), stop);
  count_rivals(stop);
}

// Divides the leaves into shares of equal work by recursive bisection (Berger, Bokhari, IEEE Trans. Comput.
// C-36, 1987).
void RefinementQueue::divide(std::span<LeafId> leaves, std::size_t first_share, std::size_t num_shares,
                             const std::stop_token& stop) {
  if (stop.stop_requested()) return;
  if (num_shares == 1) {
    for (const LeafId leaf : leaves) move(leaf, first_share);
    return;
  }
  const std::size_t half = num_shares / 2;
  const std::size_t middle = bisect(leaves, static_cast<double>(half) / static_cast<double>(num_shares));
  divide(leaves.first(middle), first_share, half, stop);
  divide(leaves.subspan(middle), first_share + half, num_shares - half, stop);
}

// Sorts the leaves along the longest side of their box. Returns the number of first leaves that have the
// given share of the work: the poor cells, plus one for each leaf.
std::size_t RefinementQueue::bisect(std::span<LeafId> leaves, double share) const {
  GridPoint low{~0u, ~0u, ~0u}, high{};
  double total = 0;
  const auto work = [&](LeafId leaf) { return 1 + static_cast<double>(num_poor_[leaf]); };
  for (const LeafId leaf : leaves) {
    total += work(leaf);
    for (unsigned axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], octree_.cube(leaf).corner[axis]);
      high[axis] = std::max(high[axis], octree_.cube(leaf).corner[axis]);
    }
  }
  unsigned longest = 0;
  for (unsigned axis = 1; axis < 3; ++axis)
    if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
  std::vector<std::uint64_t> by_corner;  // the corner and the leaf: comparisons need no look-up
  by_corner.reserve(leaves.size());
  for (const LeafId leaf : leaves)
    by_corner.push_back(std::uint64_t{octree_.cube(leaf).corner[longest]} << 32 | leaf);
  std::sort(by_corner.begin(), by_corner.end());
  std::transform(by_corner.begin(), by_corner.end(), leaves.begin(),
                 [](std::uint64_t key) { return static_cast<LeafId>(key); });
  std::size_t count = 0;
  for (double before = 0; count < leaves.size() && before < share * total; ++count)
    before += work(leaves[count]);
  return count;
}

void RefinementQueue::move(LeafId leaf, std::size_t to) {
  if (is_ready(leaf)) ready_of(leaf).erase(key(leaf));
  num_poor_of_share_[share_of_[leaf]] -= num_poor_[leaf];
  num_poor_of_share_[to] += num_poor_[leaf];
  share_of_[leaf] = to;
  if (is_ready(leaf)) ready_of(leaf).insert(key(leaf));
}

// Sets num_rivals_. A leaf that is taken over later keeps its number.
void RefinementQueue::count_rivals(const std::stop_token& stop) {
  for (LeafId leaf = 0; leaf < octree_.num_leaves() && !stop.stop_requested(); ++leaf) {
    const std::vector<LeafId> zones = buffer_zones(leaf);
    const auto is_rival = [&](LeafId near) { return share_of_[near] != share_of_[leaf]; };
    if (is_ready(leaf)) ready_of(leaf).erase(key(leaf));
    num_rivals_[leaf] = static_cast<std::uint32_t>(std::count_if(zones.begin(), zones.end(), is_rival));
    if (is_ready(leaf)) ready_of(leaf).insert(key(leaf));
  }
}

// Moves half of the share with most poor cells to the node, if the node's own share has none. Waiting nodes
// call this at every change, so leaves are scanned only if there are poor cells to take.
void RefinementQueue::take_over(unsigned node) {
  const auto most = std::max_element(num_poor_of_share_.begin(), num_poor_of_share_.end());
  if (num_poor_of_share_[node] > 0 || *most == 0) return;
  const auto richest = static_cast<std::size_t>(most - num_poor_of_share_.begin());
  std::vector<LeafId> leaves;
  for (LeafId leaf = 0; leaf < octree_.num_leaves(); ++leaf)
    if (share_of_[leaf] == richest && num_poor_[leaf] > 0) leaves.push_back(leaf);
  for (const LeafId leaf : std::span(leaves).first(bisect(leaves, 0.5))) move(leaf, node);
}

void RefinementQueue::push(LeafId leaf, std::uint64_t num_poor) {
  if (num_poor == 0) return;
  const std::lock_guard lock(mutex_);
  if (is_ready(leaf)) ready_of(leaf).erase(key(leaf));
  if (num_poor_[leaf] == 0) ++num_pending_;
  num_poor_[leaf] += num_poor;
  num_poor_of_share_[share_of_[leaf]] += num_poor;
  if (is_ready(leaf)) ready_of(leaf).insert(key(leaf));
}

RefinementQueue::Popped RefinementQueue::pop_or_wait(unsigned node, const std::stop_token& stop) {
  const std::lock_guard lock(mutex_);
  if (stop.stop_requested()) return {std::nullopt, false};
  const std::optional<LeafId> leaf = take(node);
  const bool must_wait = !leaf && num_pending_ + num_active_ > 0;
  if (must_wait) {
    is_waiting_[node] = true;
    ++num_waiting_;
  }
  return {leaf, must_wait};
}

void RefinementQueue::wake_all(unsigned first) {
  const auto num_nodes = static_cast<unsigned>(is_waiting_.size());
  for (unsigned i = 0; i < num_nodes && num_waiting_ > 0; ++i) {
    const unsigned node = (first + i) % num_nodes;
    if (!is_waiting_[node]) continue;
    is_waiting_[node] = false;
    --num_waiting_;
    wake_(node);
  }
}

void RefinementQueue::finish(LeafId leaf) {
  const std::vector<LeafId> zones = buffer_zones(leaf);
  const std::lock_guard lock(mutex_);
  set_active(zones, false);
  wake_all(node_of_active_[leaf] + 1);
}

std::uint64_t RefinementQueue::home_rank(LeafId leaf) const {
  constexpr std::uint64_t kMostDigits = 64, kMostRivals = 1023;  // in uniform trees there are at most 124
  const auto num_digits = static_cast<std::uint64_t>(std::bit_width(num_poor_[leaf]));
  return (kMostDigits - num_digits) * (kMostRivals + 1) +
         (kMostRivals - std::min<std::uint64_t>(num_rivals_[leaf], kMostRivals));
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
        return home_rank(leaf);
      case LeafOrder::kMostWork:
        break;
    }
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    return kMost - std::min(num_poor_[leaf], kMost);
  };
  return rank() << 32 | leaf;
}

// Returns L, B1 and B2.
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
  is_active ? ++num_active_ : --num_active_;
}

std::optional<LeafId> RefinementQueue::take(unsigned node) {
  const bool is_home = order_ == LeafOrder::kHome;
  if (is_home && ready_[node].empty()) take_over(node);
  const std::set<Key>& ready = ready_[is_home ? node : 0];
  if (ready.empty()) return std::nullopt;
  Key& resume_at = resume_at_[order_ == LeafOrder::kMorton ? node : 0];
  const auto next = ready.lower_bound(resume_at);
  const Key taken = next != ready.end() ? *next : *ready.begin();
  if (order_ == LeafOrder::kMorton || order_ == LeafOrder::kColoring) resume_at = taken;
  const auto leaf = static_cast<LeafId>(taken);
  set_active(buffer_zones(leaf), true);
  node_of_active_[leaf] = node;
  num_poor_of_share_[share_of_[leaf]] -= std::exchange(num_poor_[leaf], 0);
  --num_pending_;
  return leaf;
}

}  // namespace podm
