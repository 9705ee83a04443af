#include "refine/line_edges.h"

#include <algorithm>
#include <cmath>

#include "podm/errors.h"

namespace podm {

namespace {

constexpr double kIrregular = 1e-3;

}  // namespace

LineEdges::LineEdges(const Lines& lines, double delta_mm, double floor_mm, std::size_t vertex_capacity)
    : lines_(lines),
      delta_mm_(delta_mm),
      floor_mm_(floor_mm),
      records_(vertex_capacity),
      vertex_of_node_(lines.network().nodes.size(), kNoVertex),
      ends_of_node_(lines.network().nodes.size()),
      start_of_arc_(lines.num_arcs(), kNoVertex) {}

void LineEdges::set_node(std::size_t node, VertexId v) {
  vertex_of_node_[node] = v;
  records_[v] = {kAtNode + static_cast<std::uint32_t>(node), kNoVertex, kNoVertex, 0, 0, 0};
}

void LineEdges::join(std::size_t arc, const std::vector<Sample>& inner) {
  const LineArc& of = lines_.network().arcs[arc];
  const auto number = static_cast<std::uint32_t>(arc);
  const double length = lines_.arc(arc).length();
  std::vector<Sample> all = inner;
  for (const Sample& sample : inner)
    records_[sample.vertex] = {number, kNoVertex, kNoVertex, 0, sample.position, 0};
  if (of.is_closed()) {
    all.push_back({inner.front().vertex, inner.front().position + length});
  } else {
    const auto first = static_cast<std::size_t>(of.first_node), last = static_cast<std::size_t>(of.last_node);
    all.insert(all.begin(), {vertex_of_node_[first], 0});
    all.push_back({vertex_of_node_[last], length});
    ends_of_node_[first].push_back({number, true, kNoVertex, 0});
    ends_of_node_[last].push_back({number, false, kNoVertex, 0});
  }
  start_of_arc_[arc] = all.front().vertex;
  for (std::size_t i = 1; i < all.size(); ++i) {
    set_neighbor(all[i - 1].vertex, number, Side::kAfter, all[i]);
    set_neighbor(all[i].vertex, number, Side::kBefore, all[i - 1]);
  }
}

LineEdges::NodeEnd& LineEdges::end_at(VertexId node_vertex, std::uint32_t arc, bool is_start) {
  for (NodeEnd& end : ends_of_node_[records_[node_vertex].arc - kAtNode])
    if (end.arc == arc && end.is_start == is_start) return end;
  throw InternalError("an arc does not end at its node");
}

void LineEdges::set_neighbor(VertexId v, std::uint32_t arc, Side side, const Sample& neighbor) {
  const bool is_after = side == Side::kAfter;
  if (Record& record = records_[v]; record.arc < kAtNode) {
    (is_after ? record.after : record.before) = neighbor.vertex;
    (is_after ? record.to : record.from) = neighbor.position;
  } else {
    NodeEnd& end = end_at(v, arc, is_after);
    end.neighbor = neighbor.vertex;
    end.position = neighbor.position;
  }
}

LineEdge LineEdges::edge_after(VertexId v, std::uint32_t arc) const {
  LineEdge edge{v, kNoVertex, arc, 0, 0};
  for_each_edge_of(v, [&](const LineEdge& of) {
    if (of.first == v && of.arc == arc && edge.last == kNoVertex) edge = of;
  });
  return edge;
}

// Edges at a node are cut where their length from the node is a power of two. The first edges of all arcs at
// the node then have lengths of one power after a few splits, and none of them has an end of another in its
// ball, whatever the angle between the arcs. In a flat box the lengths differ a little by arc: where arcs are
// symmetric, ends on one circle would make flat cells (algorithms/sample_lines.cpp).
double LineEdges::split_position(const LineEdge& edge) const {
  const Arc& arc = lines_.arc(edge.arc);
  const double length = arc.length_between(edge.from, edge.to);
  const bool starts_at_node = records_[edge.first].arc >= kAtNode,
             ends_at_node = records_[edge.last].arc >= kAtNode;
  if (starts_at_node == ends_at_node) return arc.middle(edge.from, edge.to);
  // the power of two in (1/3, 2/3] of the length
  const double power = std::exp2(std::floor(std::log2(length * 2 / 3)));
  const double shell =
      lines_.is_box_flat() ? power * (1 - kIrregular * std::fabs(std::sin(78.2 * edge.arc))) : power;
  return starts_at_node ? edge.from + shell : edge.to - shell;
}

LinePoint LineEdges::point_at(std::size_t arc, double position) const {
  const std::optional<SurfacePoint> exact = lines_.exact_point(arc, position);
  return {exact ? *exact : lines_.point(arc, position), position, exact.has_value()};
}

// Near nodes that stand for several the arc is not exactly on its line, and the exact point may be far. Both
// ends are in the planes of the arc's sides, and so is their middle, to the bit.
LinePoint LineEdges::split_point_in_ball(const LineEdge& edge, const Point& a, const Point& b) const {
  const auto is_in_ball = [&](const Point& p) { return is_in_diametral_ball(p, a, b); };
  LinePoint at = split_point(edge);
  if (is_in_ball(at.point)) return at;
  at.is_exact = false;
  at.point = lines_.point(edge.arc, at.position);
  if (!is_in_ball(at.point)) at.point = {a + 0.5 * (b - a), at.point.sides};
  return at;
}

void LineEdges::split(const LineEdge& edge, VertexId v, const LinePoint& at) {
  records_[v] = {edge.arc, edge.first, edge.last, edge.from, at.position, edge.to};
  step();
  set_neighbor(edge.first, edge.arc, Side::kAfter, {v, at.position});
  step();
  set_neighbor(edge.last, edge.arc, Side::kBefore, {v, at.position});
  num_splits.fetch_add(1, std::memory_order_relaxed);
  if (!at.is_exact) num_inexact.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace podm
