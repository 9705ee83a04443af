// The table of edges of lines: joins, splits, shells around nodes, and new ids.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "refine/line_edges.h"
#include "tests/images.h"

namespace podm::test {
namespace {

constexpr VertexId kFirstNode = 3, kLastNode = 8;

// An arc of length 10 between two nodes, and a closed arc with sides 4.
LineNetwork network() {
  LineNetwork network;
  network.nodes = {{.point = {0, 0, 0}, .labels = {0, 1, 2}}, {.point = {10, 0, 0}, .labels = {0, 1, 2}}};
  network.arcs = {
      {.points = {{0, 0, 0}, {4, 0, 0}, {10, 0, 0}}, .first_node = 0, .last_node = 1, .labels = {0, 1, 2}},
      {.points = {{0, 9, 0}, {4, 9, 0}, {4, 13, 0}, {0, 13, 0}, {0, 9, 0}}, .labels = {0, 1, 2}}};
  return network;
}

class LineTable : public testing::Test {
 protected:
  LineTable() {
    edges_.set_node(0, kFirstNode);
    edges_.set_node(1, kLastNode);
    edges_.join(0, {{20, 5.0}});
    edges_.join(1, {{30, 0.0}, {31, 6.0}, {32, 11.0}});
  }

  std::vector<VertexId> vertices_of(std::size_t arc) const {
    std::vector<VertexId> vertices;
    edges_.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
      if (vertices.empty()) vertices.push_back(edge.first);
      EXPECT_EQ(vertices.back(), edge.first);
      vertices.push_back(edge.last);
    });
    return vertices;
  }
  double length_of(std::size_t arc) const {
    double sum = 0;
    edges_.for_each_edge_of_arc(arc, [&](const LineEdge& edge) { sum += edges_.length(edge); });
    return sum;
  }
  std::vector<LineEdge> edges_of(VertexId v) const {
    std::vector<LineEdge> edges;
    edges_.for_each_edge_of(v, [&](const LineEdge& edge) { edges.push_back(edge); });
    return edges;
  }

  LabelImage image_ = ball(4, 1);
  Lines lines_{network(), image_, nullptr};
  LineEdges edges_{lines_, 6, 0.5, 1000};
};

TEST_F(LineTable, JoinsTheVerticesOfAnArcInItsOrder) {
  EXPECT_EQ(vertices_of(0), (std::vector<VertexId>{kFirstNode, 20, kLastNode}));
  EXPECT_EQ(vertices_of(1), (std::vector<VertexId>{30, 31, 32, 30}));
  EXPECT_DOUBLE_EQ(length_of(0), 10);
  EXPECT_DOUBLE_EQ(length_of(1), 16);
  EXPECT_EQ(edges_of(kFirstNode).size(), 1u);
  EXPECT_EQ(edges_of(20).size(), 2u);
}

TEST_F(LineTable, HasAnEdgeInTheRecordsOfBothItsEnds) {
  for (const VertexId v : {30u, 31u, 32u, 20u})
    for (const LineEdge& edge : edges_of(v)) {
      const VertexId other = edge.first == v ? edge.last : edge.first;
      const auto of_other = edges_of(other);
      EXPECT_TRUE(std::ranges::any_of(of_other, [&](const LineEdge& e) { return e.is_same(edge); })) << v;
    }
}

TEST_F(LineTable, SplitsKeepTheLengthOfAnArc) {
  for (int i = 0; i < 40; ++i) {
    const std::size_t arc = i % 2 == 0 ? 0 : 1;
    std::vector<LineEdge> all;
    edges_.for_each_edge_of_arc(arc, [&](const LineEdge& edge) { all.push_back(edge); });
    const LineEdge edge = all[static_cast<std::size_t>(7 * i) % all.size()];
    if (!edges_.may_be_split(edge)) continue;
    const double length = edges_.length(edge);
    const LinePoint at = edges_.split_point(edge);
    const VertexId v = 100 + static_cast<VertexId>(i);
    edges_.split(edge, v, at);
    ASSERT_NEAR(length_of(arc), arc == 0 ? 10 : 16, 1e-9);
    for (const LineEdge& part : edges_of(v)) {
      EXPECT_GE(edges_.length(part), length / 3 * (1 - 1e-9));
      EXPECT_LE(edges_.length(part), length * 2 / 3 * (1 + 1e-9));
    }
  }
}

TEST_F(LineTable, CutsEdgesAtNodesAtPowersOfTwo) {
  const double position = edges_.split_point(edges_of(kFirstNode)[0]).position;
  EXPECT_DOUBLE_EQ(position, std::exp2(std::round(std::log2(position))));
  const double to_end = 10 - edges_.split_point(edges_of(kLastNode)[0]).position;
  EXPECT_DOUBLE_EQ(to_end, std::exp2(std::round(std::log2(to_end))));
}

TEST_F(LineTable, SplitsWithinTheBallOfTheEdge) {
  const LineEdge edge = edges_of(kFirstNode)[0];
  const Point a{0, 5, 0}, b{0.5, 5, 0};  // far from the arc
  const Point p = edges_.split_point_in_ball(edge, a, b).point;
  EXPECT_LT(dot(a - p, b - p), 0);
}

TEST_F(LineTable, IsTheSameAfterVerticesHaveNewIds) {
  edges_.split(edges_of(31)[0], 40, edges_.split_point(edges_of(31)[0]));
  const std::vector<VertexId> open = vertices_of(0), closed = vertices_of(1);
  const auto now = [](VertexId v) { return v % 2 == 0 ? v + 1 : v - 1; };  // pairs change places
  edges_.rename(now);
  const auto renamed = [&](std::vector<VertexId> vertices) {
    for (VertexId& v : vertices) v = now(v);
    return vertices;
  };
  EXPECT_EQ(vertices_of(0), renamed(open));
  EXPECT_EQ(vertices_of(1), renamed(closed));
  EXPECT_EQ(edges_.vertex_of_node(0), now(kFirstNode));
  EXPECT_NEAR(length_of(1), 16, 1e-9);
}

}  // namespace
}  // namespace podm::test
