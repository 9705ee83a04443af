// R0: edges of lines stay in the mesh, with three labels around them (rules.h). A worker asks before each
// insertion, and splits edges. An edge at the floor is not split, and may be lost.
//
// An edge whose diametral ball holds no vertex is an edge of every Delaunay triangulation of these vertices.
// A planned point in its ball is not inserted; the edge is split instead. Both ends are vertices of the
// cavity of such a point: the middle m of the edge lies in the Voronoi polygon of the edge, as no vertex is
// nearer to m than the ends. The new point is nearer, so it takes a part of the polygon with one of the
// corners, which is the center of a cell with the edge. That cell is in the cavity.
//
// An edge's new vertex lies on the curve, not on the edge. It may lie in the ball of another edge, and an old
// vertex may lie in the ball of an edge that it makes. The new edges are in the mesh: their common vertex is
// joined to all vertices of its cavity. The other edge is either split first, or stays in the mesh, next to a
// new cell. The ball of an edge in the mesh holds a vertex only if it holds a vertex of one of the cells
// around the edge. Each new cell is examined, and R0 splits its edges with another of its vertices in their
// balls.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "delaunay/operation.h"
#include "delaunay/walk.h"
#include "lines/few_labels.h"
#include "refine/line_edges.h"
#include "refine/rules.h"

namespace podm {

template <class Locks>
class LineKeeper {
 public:
  /// Keeps all references.
  LineKeeper(const Mesh& mesh, const Rules& rules, Operation<Locks>& operation, LineEdges& edges)
      : mesh_(mesh), rules_(rules), operation_(operation), edges_(edges) {}

  /// Begins the search for edges that have a point in their balls.
  void begin_search() { tried_.clear(); }
  /// Looks for an edge that can be split and has p, the point of the insertion planned last, in its ball.
  /// Finds each edge once per search.
  bool is_encroached_by(const Point& p);
  /// Looks for an edge of the reserved cell with another vertex of the cell in its ball, and may lock the
  /// cell's vertices. kDone: has_found() states if there is one.
  StepResult look_in(CellId c);
  bool has_found() const { return edge_.has_value(); }
  /// Looks for an edge of a cell in which look_in() found none, around which fewer than three labels of its
  /// line are.
  /// Returns a point of the isosurface where one of them begins, and a cell around the edge in conflict with
  /// it. If there is no such point, has_found() states if the edge is to be split.
  std::optional<SurfaceCenter> sample_of_missing(CellId c);
  /// Plans the insertion of a vertex that splits the edge found last, or an edge that would be lost
  /// otherwise. An earlier plan must have been rolled back. kAtFloor: there is no such vertex. The caller
  /// must roll back unless the result is kDone.
  StepResult plan_split();
  const SurfacePoint& point() const { return split_.point; }
  /// Writes the split to the table. The planned vertex has been inserted.
  void commit(VertexId inserted) { edges_.split(*edge_, inserted, split_); }
  LineEdges& edges() { return edges_; }

 private:
  // Splits that make way for each other in one attempt.
  static constexpr int kMostTransfers = 4;

  bool is_in_ball(const Point& p, const LineEdge& edge) const {
    return is_in_diametral_ball(p, mesh_.point(edge.first), mesh_.point(edge.last));
  }
  bool find_encroached(const Point& p, bool for_split);
  bool was_tried(const LineEdge& edge) const {
    return std::any_of(tried_.begin(), tried_.end(), [&](const LineEdge& of) { return of.is_same(edge); });
  }
  std::optional<CellId> cell_of_region_with(const LineEdge& edge) const;
  const std::vector<LabelIndex>& labels_of_line(const LineEdge& edge) const {
    return edges_.lines().network().arcs[edge.arc].labels;
  }
  bool has_three_labels(const LineEdge& edge, CellId c);
  std::optional<SurfaceCenter> sample_of_missing(const LineEdge& edge) const;

  const Mesh& mesh_;
  const Rules& rules_;
  Operation<Locks>& operation_;
  LineEdges& edges_;
  std::optional<LineEdge> edge_;
  std::vector<LineEdge> tried_;
  CellId around_ = 0;  // a cell with the edge
  LinePoint split_{};
  std::vector<VertexId> on_lines_;  // scratch
  std::vector<CellId> around_edge_;
  FewLabels present_;
};

template <class Locks>
std::optional<CellId> LineKeeper<Locks>::cell_of_region_with(const LineEdge& edge) const {
  for (const CellId c : operation_.region_cells()) {
    const Cell& cell = mesh_.cell(c);
    if (cell.has(edge.first) && cell.has(edge.last)) return c;
  }
  return std::nullopt;
}

template <class Locks>
bool LineKeeper<Locks>::is_encroached_by(const Point& p) {
  const bool is_found = find_encroached(p, false);
  if (is_found) tried_.push_back(*edge_);
  return is_found;
}

// For a split only edges count that the insertion would take out of the mesh.
template <class Locks>
bool LineKeeper<Locks>::find_encroached(const Point& p, bool for_split) {
  on_lines_.clear();
  operation_.for_each_region_vertex_near(std::numeric_limits<double>::infinity(), [&](VertexId v) {
    if (mesh_.vertex(v).kind == VertexKind::kLine &&
        std::find(on_lines_.begin(), on_lines_.end(), v) == on_lines_.end())
      on_lines_.push_back(v);
  });
  std::optional<LineEdge> found;
  for (const VertexId v : on_lines_)
    edges_.for_each_edge_of(v, [&](const LineEdge& edge) {
      if (found || edge.first != v || !is_in_ball(p, edge) || !edges_.may_be_split(edge)) return;
      if (for_split && (edge.is_same(*edge_) || operation_.keeps_edge(v, edge.last))) return;
      if (!for_split && was_tried(edge)) return;
      const auto around = cell_of_region_with(edge);
      if (!around) return;
      found = edge;
      around_ = *around;
    });
  if (found) edge_ = found;
  return found.has_value();
}

template <class Locks>
StepResult LineKeeper<Locks>::look_in(CellId c) {
  edge_.reset();
  const std::array<VertexId, 4> vertices = mesh_.cell(c).vertices;
  const auto num_on_lines = std::count_if(vertices.begin(), vertices.end(), [&](VertexId v) {
    return mesh_.vertex(v).kind == VertexKind::kLine;
  });
  if (num_on_lines < 2) return StepResult::kDone;
  if (const StepResult held = operation_.hold(c); held != StepResult::kDone) return held;
  for (const VertexId v : vertices) {
    if (mesh_.vertex(v).kind != VertexKind::kLine) continue;
    edges_.for_each_edge_of(v, [&](const LineEdge& edge) {
      if (edge_ || edge.first != v || !edges_.may_be_split(edge)) return;
      if (!mesh_.cell(c).has(edge.last)) return;
      const bool is_encroached = std::any_of(vertices.begin(), vertices.end(), [&](VertexId w) {
        return w != v && w != edge.last && is_in_ball(mesh_.point(w), edge);
      });
      if (is_encroached) edge_ = edge;
    });
  }
  around_ = c;
  return StepResult::kDone;
}

template <class Locks>
std::optional<SurfaceCenter> LineKeeper<Locks>::sample_of_missing(CellId c) {
  const std::array<VertexId, 4> vertices = mesh_.cell(c).vertices;
  const auto is_on_line = [&](VertexId v) { return mesh_.vertex(v).kind == VertexKind::kLine; };
  if (std::count_if(vertices.begin(), vertices.end(), is_on_line) < 2) return std::nullopt;
  std::optional<SurfaceCenter> sample;
  for (const VertexId v : vertices) {
    if (!is_on_line(v)) continue;
    edges_.for_each_edge_of(v, [&](const LineEdge& edge) {
      if (sample || edge.first != v || !mesh_.cell(c).has(edge.last) || has_three_labels(edge, c)) return;
      sample = sample_of_missing(edge);
      if (!sample && edges_.may_be_split(edge)) edge_ = edge;
    });
  }
  return sample;
}

// Leaves the cells around the edge in around_edge_, and labels of its line that they have in present_.
template <class Locks>
bool LineKeeper<Locks>::has_three_labels(const LineEdge& edge, CellId c) {
  const std::vector<LabelIndex>& wanted = labels_of_line(edge);
  present_ = {};
  around_edge_.clear();
  find_around_edge(mesh_, c, edge.first, edge.last, [&](CellId each) {
    around_edge_.push_back(each);
    const LabelIndex label = rules_.label_of(each);
    if (present_.size() < 3 && std::ranges::binary_search(wanted, label)) present_.insert(label);
    return false;
  });
  return present_.size() >= 3;
}

// The centers of the cells around an edge are the corners of its Voronoi polygon. If the line crosses the
// polygon, a wedge between two sheets that has no corner is crossed by a side of the polygon. Otherwise the
// edge is too far from the line.
template <class Locks>
std::optional<SurfaceCenter> LineKeeper<Locks>::sample_of_missing(const LineEdge& edge) const {
  const std::vector<LabelIndex>& wanted = labels_of_line(edge);
  const auto is_missing = [&](LabelIndex label) {
    return !present_.contains(label) && std::binary_search(wanted.begin(), wanted.end(), label);
  };
  const Point& end = mesh_.point(edge.first);
  for (std::size_t i = 0; i < around_edge_.size(); ++i) {
    const CellId next = around_edge_[(i + 1) % around_edge_.size()];
    for (const auto& [from, to] : {std::pair(around_edge_[i], next), std::pair(next, around_edge_[i])}) {
      const auto crossing = rules_.first_crossing(mesh_.cell(from).center, mesh_.cell(to).center);
      if (!crossing || !is_missing(crossing->beyond)) continue;
      const double radius_mm = distance(crossing->point, end);  // of an empty ball
      const SurfacePoint z = rules_.near_sides(crossing->point, radius_mm);
      if (radius_mm - distance(z, crossing->point) < edges_.floor_mm()) continue;
      if (const auto sample = rules_.in_conflict(z, from, to)) return sample;
    }
  }
  return std::nullopt;
}

template <class Locks>
StepResult LineKeeper<Locks>::plan_split() {
  for (int transfer = 0; transfer < kMostTransfers; ++transfer) {
    split_ = edges_.split_point_in_ball(*edge_, mesh_.point(edge_->first), mesh_.point(edge_->last));
    if (!split_.is_exact) {
      const std::optional<SurfacePoint> settled = rules_.settled_on_sides(split_.point, edges_.delta_mm());
      if (!settled || !is_in_ball(*settled, *edge_)) return StepResult::kAtFloor;
      split_.point = *settled;
    }
    const auto start = find_around_edge(mesh_, around_, edge_->first, edge_->last,
                                        [&](CellId c) { return mesh_.is_in_conflict(c, split_.point); });
    if (!start) return StepResult::kAtFloor;
    if (const StepResult planned = operation_.plan_insertion(split_.point, *start);
        planned != StepResult::kDone)
      return planned;
    if (!find_encroached(split_.point, true)) return StepResult::kDone;
    operation_.rollback();
  }
  return StepResult::kAtFloor;
}

}  // namespace podm
