#include "lines/chains.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>

#include "lines/polyline.h"

namespace podm {

namespace {

bool share_a_joint(const Chain& a, const Chain& b) {
  return a.ends[0] == b.ends[0] || a.ends[0] == b.ends[1] || a.ends[1] == b.ends[0] || a.ends[1] == b.ends[1];
}

// The nearest points of two chains.
struct NearMiss {
  double distance;
  std::array<std::size_t, 2> segments;
  std::array<Point, 2> points;
};

// The place where two chains come closest, unless that is close to their ends or not close enough.
std::optional<NearMiss> near_miss(const Chain& a, const Chain& b) {
  NearMiss nearest{kMergeDistance, {}, {}};
  bool is_found = false;
  for (std::size_t i = 0; i + 1 < a.points.size(); ++i) {
    for (std::size_t j = 0; j + 1 < b.points.size(); ++j) {
      const Point &p = a.points[i], &q = a.points[i + 1], &r = b.points[j], &s = b.points[j + 1];
      const auto [of_a, of_b] = nearest_shares(p, q, r, s);
      const Point x = p + of_a * (q - p), y = r + of_b * (s - r);
      if (!(distance(x, y) < nearest.distance)) continue;
      nearest = {distance(x, y), {i, j}, {x, y}};
      is_found = true;
    }
  }
  if (!is_found) return std::nullopt;
  for (const Point& end : {a.points.front(), a.points.back(), b.points.front(), b.points.back()})
    for (const Point& p : nearest.points)
      if (distance(p, end) < 2 * kMergeDistance) return std::nullopt;
  return nearest;
}

// Cuts a chain in two at a new joint. Returns the second part.
Chain split(Chain& chain, std::size_t segment, int joint, const Point& point) {
  Chain rest{{joint, chain.ends[1]}, chain.labels, {point}};
  const auto after = chain.points.begin() + static_cast<std::ptrdiff_t>(segment) + 1;
  rest.points.insert(rest.points.end(), after, chain.points.end());
  chain.points.erase(after, chain.points.end());
  chain.points.push_back(point);
  chain.ends[1] = joint;
  return rest;
}

void join_near_misses(BlockChains& block, const std::function<JointKey(std::size_t)>& new_key) {
  const std::size_t num_chains = block.chains.size();
  std::vector<bool> is_split(num_chains);
  for (std::size_t a = 0; a < num_chains; ++a) {
    for (std::size_t b = a + 1; b < num_chains && !is_split[a]; ++b) {
      Chain &first = block.chains[a], &second = block.chains[b];
      if (is_split[b] || first.is_closed() || second.is_closed() || share_a_joint(first, second)) continue;
      const std::optional<NearMiss> miss = near_miss(first, second);
      if (!miss) continue;
      const auto joint = static_cast<int>(block.joints.size());
      const Point middle = miss->points[0] + 0.5 * (miss->points[1] - miss->points[0]);
      FewLabels labels = first.labels;
      labels.insert(second.labels);
      block.joints.push_back({{new_key(block.joints.size()), middle, block.sides, labels}, true});
      is_split[a] = is_split[b] = true;
      Chain rest_of_first = split(first, miss->segments[0], joint, middle);
      Chain rest_of_second = split(second, miss->segments[1], joint, middle);
      block.chains.push_back(std::move(rest_of_first));
      block.chains.push_back(std::move(rest_of_second));
    }
  }
}

bool is_small_loop(const Chain& chain) {
  return !chain.is_closed() && chain.ends[0] == chain.ends[1] &&
         greatest_distance_from(chain.points.front(), chain.points) <= kMergeDistance;
}

bool are_parallel(const Chain& a, const Chain& b) {
  const bool have_same_ends = (a.ends[0] == b.ends[0] && a.ends[1] == b.ends[1]) ||
                              (a.ends[0] == b.ends[1] && a.ends[1] == b.ends[0]);
  return have_same_ends && !a.is_closed() && a.ends[0] != a.ends[1] &&
         are_within(a.points, b.points, kMergeDistance);
}

// The chains of a bundle after those pairs that have the same labels are removed: at most one per label set.
std::vector<std::size_t> without_pairs(const std::vector<Chain>& chains,
                                       const std::vector<std::size_t>& bundle) {
  std::vector<std::size_t> left;
  for (const std::size_t c : bundle) {
    const auto twin = std::find_if(left.begin(), left.end(), [&](std::size_t other) {
      return chains[other].labels == chains[c].labels;
    });
    if (twin != left.end())
      left.erase(twin);
    else
      left.push_back(c);
  }
  return left;
}

// On a side of the box the background outside is one of the labels.
bool is_line(const BlockChains& block, const Chain& chain) {
  FewLabels labels = chain.labels;
  if (block.sides != 0) labels.insert(kBackground);
  return labels.size() >= kLabelsOfLine;
}

void note_removed(const BlockChains& block, const Chain& chain, RemovedCurves& removed) {
  if (is_line(block, chain)) removed.length_voxels += length(chain.points);
}

void merge_parallel(BlockChains& block, RemovedCurves& removed) {
  std::vector<Chain>& chains = block.chains;
  std::vector<bool> is_done(chains.size());
  std::vector<Chain> merged;
  for (std::size_t a = 0; a < chains.size(); ++a) {
    if (is_done[a]) continue;
    std::vector<std::size_t> bundle{a};
    for (std::size_t b = a + 1; b < chains.size(); ++b)
      if (!is_done[b] && are_parallel(chains[a], chains[b])) bundle.push_back(b);
    for (const std::size_t c : bundle) is_done[c] = true;
    const std::vector<std::size_t> left = without_pairs(chains, bundle);
    if (left.size() < bundle.size() && is_line(block, chains[a]))
      removed.points.push_back(chains[a].points[chains[a].points.size() / 2]);
    for (const std::size_t c : bundle)
      if (std::ranges::find(left, c) == left.end()) note_removed(block, chains[c], removed);
    if (left.empty()) continue;
    for (const std::size_t c : left) chains[left[0]].labels.insert(chains[c].labels);
    merged.push_back(std::move(chains[left[0]]));
  }
  chains = std::move(merged);
}

}  // namespace

RemovedCurves merge_chains(BlockChains& block, const std::function<JointKey(std::size_t)>& new_key) {
  RemovedCurves removed;
  if (block.chains.size() > 1) join_near_misses(block, new_key);
  std::erase_if(block.chains, [&](const Chain& chain) {
    const bool is_small = is_small_loop(chain);
    if (is_small) note_removed(block, chain, removed);
    return is_small;
  });
  if (block.chains.size() > 1) merge_parallel(block, removed);
  return removed;
}

void append(const RemovedCurves& removed, const Voxel& block, Pieces& pieces) {
  for (const Point& p : removed.points)
    pieces.undecided.push_back({block, p, UndecidedPlace::Reason::kTooSmall});
  pieces.removed_voxels += removed.length_voxels;
}

void append(const BlockChains& block, bool has_outside, Pieces& pieces) {
  for (const auto& [joint, is_emitted] : block.joints) {
    if (!is_emitted) continue;
    pieces.joints.push_back(joint);
    if (has_outside) pieces.joints.back().labels.insert(kBackground);
  }
  for (const Chain& chain : block.chains) {
    Piece piece{{0, 0}, chain.is_closed(), block.sides, chain.labels, 0};
    if (!chain.is_closed())
      for (std::size_t e = 0; e < 2; ++e)
        piece.ends[e] = block.joints[static_cast<std::size_t>(chain.ends[e])].joint.key;
    if (has_outside) piece.labels.insert(kBackground);
    piece.num_points = static_cast<std::uint32_t>(chain.points.size());
    pieces.points.insert(pieces.points.end(), chain.points.begin(), chain.points.end());
    pieces.pieces.push_back(piece);
  }
}

}  // namespace podm
