#include "lines/line_graph.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/box.h"
#include "lines/chains.h"
#include "lines/polyline.h"

namespace podm {

namespace {

constexpr int kMostRounds = 16;
constexpr double kLeastSegment = 1e-3;  // voxels
constexpr double kLeavingShare = 2;     // of the way by which an end at a side moves

void unite(std::vector<LabelIndex>& labels, const std::vector<LabelIndex>& others) {
  std::vector<LabelIndex> all;
  std::set_union(labels.begin(), labels.end(), others.begin(), others.end(), std::back_inserter(all));
  labels = std::move(all);
}

bool is_line(const std::vector<LabelIndex>& labels) { return labels.size() >= kLabelsOfLine; }

bool contains(unsigned sides, unsigned others) { return (sides & others) == others; }

// The point of segment qr at this distance from `center`, where q is farther and r is not.
Point at_distance(const Point& center, double distance, const Point& q, const Point& r) {
  const Vector d = r - q, to_q = q - center;
  const double dd = squared_length(d), dq = dot(d, to_q);
  const double root = std::sqrt(std::max(dq * dq - dd * (squared_length(to_q) - distance * distance), 0.0));
  return dd > 0 ? q + std::clamp((-dq - root) / dd, 0.0, 1.0) * d : q;
}

// Groups of nodes that become one.
class Clusters {
 public:
  explicit Clusters(const std::vector<GraphNode>& nodes) : parent_(nodes.size()), sides_(nodes.size()) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      sides_[n] = nodes[n].sides;
      boxes_.push_back({nodes[n].point, nodes[n].point});
    }
  }

  std::size_t find(std::size_t node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }
  /// Unites the groups of two nodes if the rule permits it.
  bool unite(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    if (a == b || !(contains(sides_[a], sides_[b]) || contains(sides_[b], sides_[a]))) return false;
    const Box &p = boxes_[a], &q = boxes_[b];
    const Box both{
        {std::min(p.low.x, q.low.x), std::min(p.low.y, q.low.y), std::min(p.low.z, q.low.z)},
        {std::max(p.high.x, q.high.x), std::max(p.high.y, q.high.y), std::max(p.high.z, q.high.z)}};
    const Vector size = both.high - both.low;
    if (std::max({size.x, size.y, size.z}) > 2 * kShortArc) return false;
    const auto [first, second] = std::minmax(a, b);
    parent_[second] = first;
    boxes_[first] = both;
    sides_[first] |= sides_[second];
    return true;
  }
  std::uint8_t sides(std::size_t root) const { return sides_[root]; }

 private:
  std::vector<std::size_t> parent_;
  std::vector<std::uint8_t> sides_;
  std::vector<Box> boxes_;
};

class Simplifier {
 public:
  Simplifier(LineGraph& graph, bool leaves_sides)
      : nodes_(graph.nodes), arcs_(graph.arcs), leaves_sides_(leaves_sides) {}

  RemovedCurves operator()() {
    for (int round = 0; round < kMostRounds; ++round) {
      bool has_changed = contract_short_arcs();
      has_changed |= remove_small_loops();
      has_changed |= merge_parallel_arcs();
      has_changed |= remove_needless_nodes();
      if (!has_changed) break;
    }
    remove_short_closed_arcs();
    add_contracted();
    for (GraphArc& arc : arcs_) remove_repeated(arc.points, kLeastSegment);
    return std::move(removed_);
  }

 private:
  bool contract_short_arcs();
  void contract(Clusters& clusters);
  void move_nodes(Clusters& clusters);
  void move_end(GraphArc& arc, std::size_t end, const GraphNode& node) const;
  bool remove_small_loops();
  bool merge_parallel_arcs();
  void merge_bundle(const std::vector<std::size_t>& bundle, std::vector<bool>& is_removed);
  bool remove_needless_nodes();
  void remove_short_closed_arcs();
  void note_removed(const GraphArc& arc, std::size_t point) {
    if (!is_line(arc.labels)) return;
    removed_.points.push_back(arc.points[point]);
    removed_.length_voxels += length(arc.points);
  }
  void add_contracted();
  bool erase(const std::vector<bool>& is_removed);
  std::size_t end(std::size_t arc, std::size_t e) const {
    return static_cast<std::size_t>(arcs_[arc].ends[e]);
  }

  std::vector<GraphNode>& nodes_;
  std::vector<GraphArc>& arcs_;
  bool leaves_sides_;
  // An arc, or a part of one, that became a part of a node.
  struct Contracted {
    std::size_t node;
    double length;
    std::vector<LabelIndex> labels;
  };
  std::vector<Contracted> contracted_;
  RemovedCurves removed_;
};

bool Simplifier::erase(const std::vector<bool>& is_removed) {
  std::size_t kept = 0;
  for (std::size_t a = 0; a < arcs_.size(); ++a) {
    if (is_removed[a]) continue;
    if (kept != a) arcs_[kept] = std::move(arcs_[a]);
    ++kept;
  }
  const bool has_changed = kept < arcs_.size();
  arcs_.resize(kept);
  return has_changed;
}

bool Simplifier::contract_short_arcs() {
  std::vector<std::pair<double, std::size_t>> shortest_first;
  for (std::size_t a = 0; a < arcs_.size(); ++a) {
    if (arcs_[a].is_closed() || arcs_[a].ends[0] == arcs_[a].ends[1]) continue;
    const double l = length(arcs_[a].points);
    if (l < kShortArc) shortest_first.emplace_back(l, a);
  }
  std::sort(shortest_first.begin(), shortest_first.end());
  Clusters clusters(nodes_);
  bool has_changed = false;
  for (const auto& [l, a] : shortest_first) has_changed |= clusters.unite(end(a, 0), end(a, 1));
  if (has_changed) contract(clusters);
  return has_changed;
}

// An arc whose ends become one node is a loop from then on. What it loses of its length is noted here, and
// the rest if the loop is removed.
void Simplifier::contract(Clusters& clusters) {
  std::vector<std::pair<std::size_t, double>> closing;
  for (std::size_t a = 0; a < arcs_.size(); ++a)
    if (!arcs_[a].is_closed() && arcs_[a].ends[0] != arcs_[a].ends[1] &&
        clusters.find(end(a, 0)) == clusters.find(end(a, 1)))
      closing.emplace_back(a, length(arcs_[a].points));
  move_nodes(clusters);
  for (const auto& [a, l] : closing)
    contracted_.push_back({end(a, 0), std::max(l - length(arcs_[a].points), 0.0), arcs_[a].labels});
}

// Moves the end of an arc. The arc stays as it is outside the ball around the new place through the old one.
// An arc that ends at a side stands at right angles to it and would touch this ball: its last part would lie
// in the side.
void Simplifier::move_end(GraphArc& arc, std::size_t end, const GraphNode& node) const {
  const Point& point = node.point;
  if (end == 0) std::reverse(arc.points.begin(), arc.points.end());
  const double reach = distance(arc.points.back(), point) *
                       (leaves_sides_ && !contains(arc.sides, node.sides) ? kLeavingShare : 1);
  Point inside = arc.points.back();
  arc.points.pop_back();
  while (arc.points.size() > 1 && distance(arc.points.back(), point) <= reach) {
    inside = arc.points.back();
    arc.points.pop_back();
  }
  if (reach > kSimplifyTolerance && distance(arc.points.back(), point) > reach)
    arc.points.push_back(at_distance(point, reach, arc.points.back(), inside));
  arc.points.push_back(point);
  if (end == 0) std::reverse(arc.points.begin(), arc.points.end());
}

void Simplifier::move_nodes(Clusters& clusters) {
  for (Contracted& each : contracted_) each.node = clusters.find(each.node);
  std::vector<double> num_members(nodes_.size());
  std::vector<Point> sum(nodes_.size());
  std::vector<bool> has_changed(nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const std::size_t root = clusters.find(n);
    if (root != n) {
      has_changed[root] = true;
      unite(nodes_[root].labels, nodes_[n].labels);
    }
    // On sides of the box the first of the nodes that lie on all of them stays in place.
    const bool is_on_sides = clusters.sides(root) != 0;
    if (nodes_[n].sides != clusters.sides(root) || (is_on_sides && num_members[root] > 0)) continue;
    sum[root] = sum[root] + nodes_[n].point;
    ++num_members[root];
  }
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (!has_changed[n]) continue;
    nodes_[n].point = clusters.sides(n) != 0 ? sum[n] : (1 / num_members[n]) * sum[n];
    nodes_[n].sides = clusters.sides(n);
  }
  for (GraphArc& arc : arcs_) {
    for (std::size_t e = 0; e < 2 && !arc.is_closed(); ++e) {
      const std::size_t root = clusters.find(static_cast<std::size_t>(arc.ends[e]));
      arc.ends[e] = static_cast<std::int32_t>(root);
      const Point& old = e == 0 ? arc.points.front() : arc.points.back();
      if (!(old == nodes_[root].point)) move_end(arc, e, nodes_[root]);
    }
  }
}

bool Simplifier::remove_small_loops() {
  std::vector<bool> is_removed(arcs_.size());
  for (std::size_t a = 0; a < arcs_.size(); ++a) {
    const GraphArc& arc = arcs_[a];
    if (arc.is_closed() || arc.ends[0] != arc.ends[1]) continue;
    is_removed[a] =
        arc.points.size() < 4 || greatest_distance_from(arc.points.front(), arc.points) <= kShortArc;
    if (is_removed[a]) contracted_.push_back({end(a, 0), length(arc.points), arc.labels});
  }
  return erase(is_removed);
}

bool Simplifier::merge_parallel_arcs() {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>> by_ends;
  for (std::size_t a = 0; a < arcs_.size(); ++a)
    if (!arcs_[a].is_closed() && arcs_[a].ends[0] != arcs_[a].ends[1])
      by_ends[std::minmax(end(a, 0), end(a, 1))].push_back(a);
  std::vector<bool> is_removed(arcs_.size()), is_done(arcs_.size());
  for (const auto& [ends, group] : by_ends) {
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (is_done[group[i]]) continue;
      std::vector<std::size_t> bundle{group[i]};
      for (std::size_t j = i + 1; j < group.size(); ++j)
        if (!is_done[group[j]] && are_within(arcs_[group[i]].points, arcs_[group[j]].points, kMergeDistance))
          bundle.push_back(group[j]);
      for (const std::size_t a : bundle) is_done[a] = true;
      if (bundle.size() > 1) merge_bundle(bundle, is_removed);
    }
  }
  return erase(is_removed);
}

// Keeps one of the arcs that are left after pairs with the same labels are gone: that on most sides of the
// box.
void Simplifier::merge_bundle(const std::vector<std::size_t>& bundle, std::vector<bool>& is_removed) {
  std::vector<std::size_t> left;
  for (const std::size_t a : bundle) {
    const auto twin = std::find_if(left.begin(), left.end(), [&](std::size_t b) {
      return arcs_[a].labels == arcs_[b].labels && arcs_[a].sides == arcs_[b].sides;
    });
    is_removed[a] = true;
    if (twin == left.end()) {
      left.push_back(a);
    } else {
      note_removed(arcs_[a], arcs_[a].points.size() / 2);
      if (is_line(arcs_[*twin].labels)) removed_.length_voxels += length(arcs_[*twin].points);
      left.erase(twin);
    }
  }
  if (left.empty()) return;
  const std::size_t kept = *std::max_element(left.begin(), left.end(), [&](std::size_t a, std::size_t b) {
    return std::popcount(arcs_[a].sides) < std::popcount(arcs_[b].sides);
  });
  for (const std::size_t a : left) unite(arcs_[kept].labels, arcs_[a].labels);
  is_removed[kept] = false;
}

// Joins two arcs at a node of no other arcs, or closes one.
bool Simplifier::remove_needless_nodes() {
  std::vector<std::vector<std::size_t>> arcs_at(nodes_.size());
  for (std::size_t a = 0; a < arcs_.size(); ++a)
    for (std::size_t e = 0; e < 2 && !arcs_[a].is_closed(); ++e) arcs_at[end(a, e)].push_back(a);
  std::vector<bool> is_removed(arcs_.size());
  bool has_changed = false;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (arcs_at[n].size() != 2) continue;
    const std::size_t a = arcs_at[n][0], b = arcs_at[n][1];
    GraphArc &first = arcs_[a], &second = arcs_[b];
    if (first.labels != second.labels || first.sides != second.sides || first.sides != nodes_[n].sides)
      continue;
    has_changed = true;
    if (a == b) {
      first.ends = {-1, -1};
      continue;
    }
    const auto reverse = [](GraphArc& arc) {
      std::reverse(arc.points.begin(), arc.points.end());
      std::swap(arc.ends[0], arc.ends[1]);
    };
    if (end(a, 1) != n) reverse(first);
    if (end(b, 0) != n) reverse(second);
    first.points.insert(first.points.end(), second.points.begin() + 1, second.points.end());
    first.ends[1] = second.ends[1];
    is_removed[b] = true;
    std::vector<std::size_t>& at_last = arcs_at[end(a, 1)];
    std::replace(at_last.begin(), at_last.end(), b, a);
  }
  erase(is_removed);
  return has_changed;
}

void Simplifier::remove_short_closed_arcs() {
  std::vector<bool> is_removed(arcs_.size());
  for (std::size_t a = 0; a < arcs_.size(); ++a) {
    if (!arcs_[a].is_closed() || length(arcs_[a].points) >= kShortLoop) continue;
    is_removed[a] = true;
    note_removed(arcs_[a], 0);
  }
  erase(is_removed);
}

// Where an arc with all labels of a contracted one ends at its node, nothing is missing.
void Simplifier::add_contracted() {
  std::vector<std::vector<std::size_t>> arcs_at(nodes_.size());
  for (std::size_t a = 0; a < arcs_.size(); ++a)
    for (std::size_t e = 0; e < 2 && !arcs_[a].is_closed(); ++e) arcs_at[end(a, e)].push_back(a);
  for (const Contracted& each : contracted_)
    if (is_line(each.labels) && std::ranges::none_of(arcs_at[each.node], [&](std::size_t a) {
          return std::ranges::includes(arcs_[a].labels, each.labels);
        }))
      removed_.length_voxels += each.length;
}

}  // namespace

RemovedCurves simplify(LineGraph& graph, bool leaves_sides) { return Simplifier(graph, leaves_sides)(); }

}  // namespace podm
