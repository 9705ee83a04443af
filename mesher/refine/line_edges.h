// The edges of the mesh along lines: a table that all workers share.
//
// Consecutive vertices of an arc are joined by an edge. An edge lies in the records of both its ends. A
// record belongs to a vertex: the worker that holds the vertex's lock reads and writes it, and no other does.
//
// Proposition: no two workers access a record at the same time, and each finds what the last one wrote.
// Proof:
//   1. A worker looks up the edges of vertices of cells that it will replace, or of one cell of which it has
//      locked all vertices (Operation::hold). It holds all their locks. A lock has one holder, and passes on
//      all that its last holder wrote.
//   2. A split writes to the records of both ends, which the worker holds, and to that of the new vertex,
//      which it has made and has not locked. Another worker that holds the new vertex's lock has learnt of
//      the vertex from a cell with it. That cell has three other vertices. The worker that made the cell held
//      all of them, and knew the record: it made the vertex, or it held the vertex's lock, or it learnt of
//      the vertex in this way itself. The other worker locks one of the three after that.
//   3. Vertices on lines are never removed, and never move. Their ids change only while no worker runs
//      (Relocation). A record is therefore never freed.
// Vertices that no other worker can reach count as held (algorithms/leaf_locks.h). With NoLocks there is one
// worker. The table of arcs and the lists at nodes have their size before workers run.
//
// A split is written after the commit of its vertex, under the same locks. A worker that finds an edge
// therefore finds its vertices in the mesh. Test: Schedules (algorithms/tests/test_schedules.cpp) find that
// two locks are too few to look up edges.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "delaunay/mesh.h"
#include "lines/lines.h"
#include "runtime/huge_array.h"

namespace podm {

/// An edge along an arc, between two positions. The arc runs from the first vertex to the last.
struct LineEdge {
  VertexId first, last;
  std::uint32_t arc;
  double from, to;  // positions, mm

  /// The record of either end may give a position of a closed arc in another way.
  bool is_same(const LineEdge& other) const {
    return first == other.first && last == other.last && arc == other.arc;
  }
};

/// A new vertex for an edge.
struct LinePoint {
  SurfacePoint point;
  double position;
  bool is_exact;
};

class LineEdges {
 public:
  /// Lines are sampled at `delta_mm`. Edges shorter than `floor_mm` are not split. Keeps a reference to
  /// `lines`.
  LineEdges(const Lines& lines, double delta_mm, double floor_mm, std::size_t vertex_capacity);

  const Lines& lines() const { return lines_; }
  double delta_mm() const { return delta_mm_; }
  double floor_mm() const { return floor_mm_; }

  // ---- Before workers run ----

  /// The point of an arc at a position. It is on the line exactly unless that point is not found.
  LinePoint point_at(std::size_t arc, double position) const;
  /// Makes v the vertex of a node.
  void set_node(std::size_t node, VertexId v);
  /// kNoVertex: the node has no vertex.
  VertexId vertex_of_node(std::size_t node) const { return vertex_of_node_[node]; }
  struct Sample {
    VertexId vertex;
    double position;
  };
  /// Joins the vertices of an arc: those of its nodes and `inner` between them; for a closed arc all vertices
  /// are `inner`.
  void join(std::size_t arc, const std::vector<Sample>& inner);
  /// Gives all vertices their new ids.
  template <class VertexNow>
  void rename(const VertexNow& now);

  // ---- Under the lock of v ----

  /// Calls visit(edge) for the edges of v, a vertex on lines.
  template <class Visit>
  void for_each_edge_of(VertexId v, const Visit& visit) const {
    step();
    const Record& record = records_[v];
    if (record.arc < kAtNode) {
      visit({record.before, v, record.arc, record.from, record.at});
      visit({v, record.after, record.arc, record.at, record.to});
      return;
    }
    for (const NodeEnd& end : ends_of_node_[record.arc - kAtNode]) {
      const double length = lines_.arc(end.arc).length();
      visit(end.is_start ? LineEdge{v, end.neighbor, end.arc, 0, end.position}
                         : LineEdge{end.neighbor, v, end.arc, end.position, length});
    }
  }

  // ---- Under the locks of both ends ----

  double length(const LineEdge& edge) const {
    return lines_.arc(edge.arc).length_between(edge.from, edge.to);
  }
  bool may_be_split(const LineEdge& edge) const { return length(edge) >= floor_mm_; }
  /// Returns the point that splits an edge: the middle of its arc, or where a shell around a node cuts it.
  LinePoint split_point(const LineEdge& edge) const { return point_at(edge.arc, split_position(edge)); }
  /// Returns a point that splits an edge from a to b and is in the ball of the edge.
  LinePoint split_point_in_ball(const LineEdge& edge, const Point& a, const Point& b) const;
  /// Joins the new vertex to both ends in place of the edge.
  void split(const LineEdge& edge, VertexId v, const LinePoint& at);

  // ---- While no worker runs ----

  /// Calls visit(edge) for the edges of an arc.
  template <class Visit>
  void for_each_edge_of_arc(std::size_t arc, const Visit& visit) const;

  /// Counts of splits, and of vertices whose exact place was not found.
  std::atomic<std::uint64_t> num_splits = 0, num_inexact = 0;

 private:
  static constexpr std::uint32_t kAtNode = 1u << 31;
  // `arc` is kAtNode + node for a node's vertex, which needs nothing else.
  struct Record {
    std::uint32_t arc;
    VertexId before, after;
    double from, at, to;  // positions of the vertex before, of this one and of the one after
  };
  struct NodeEnd {
    std::uint32_t arc;
    bool is_start;  // the arc starts here, otherwise it ends
    VertexId neighbor;
    double position;  // of the neighbor
  };

  NodeEnd& end_at(VertexId node_vertex, std::uint32_t arc, bool is_start);
  // The two neighbours of a vertex along an arc.
  enum class Side { kBefore, kAfter };
  void set_neighbor(VertexId v, std::uint32_t arc, Side side, const Sample& neighbor);
  LineEdge edge_after(VertexId v, std::uint32_t arc) const;
  double split_position(const LineEdge& edge) const;

  const Lines& lines_;
  double delta_mm_, floor_mm_;
  HugeArray<Record> records_;  // by vertex
  std::vector<VertexId> vertex_of_node_;
  std::vector<std::vector<NodeEnd>> ends_of_node_;
  std::vector<VertexId> start_of_arc_;  // a vertex of each arc, the first one of an open arc; or none
};

template <class VertexNow>
void LineEdges::rename(const VertexNow& now) {
  const auto rename = [&](VertexId& v) {
    if (v != kNoVertex) v = now(v);
  };
  std::vector<std::pair<VertexId, Record>> renamed;
  for (std::size_t arc = 0; arc < start_of_arc_.size(); ++arc)
    for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
      Record record = records_[edge.first];
      if (record.arc >= kAtNode) return;
      rename(record.before);
      rename(record.after);
      renamed.emplace_back(now(edge.first), record);
    });
  for (std::size_t node = 0; node < vertex_of_node_.size(); ++node) {
    for (NodeEnd& end : ends_of_node_[node]) rename(end.neighbor);
    rename(vertex_of_node_[node]);
    if (vertex_of_node_[node] != kNoVertex)
      renamed.emplace_back(vertex_of_node_[node],
                           Record{kAtNode + static_cast<std::uint32_t>(node), kNoVertex, kNoVertex, 0, 0, 0});
  }
  for (VertexId& v : start_of_arc_) rename(v);
  for (const auto& [v, record] : renamed) records_[v] = record;
}

template <class Visit>
void LineEdges::for_each_edge_of_arc(std::size_t arc, const Visit& visit) const {
  const VertexId start = start_of_arc_[arc];
  if (start == kNoVertex) return;
  VertexId v = start;
  do {
    const LineEdge edge = edge_after(v, static_cast<std::uint32_t>(arc));
    visit(edge);
    v = edge.last;
  } while (v != start && records_[v].arc < kAtNode);
}

}  // namespace podm
