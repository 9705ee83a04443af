// The cells around the edges of lines, looked at in one pass over all cells.
#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "delaunay/mesh.h"
#include "refine/line_edges.h"

namespace podm {

/// Labels in ascending order, without repetitions.
using LabelSet = std::vector<LabelIndex>;

/// Names an edge, whatever the order of its ends.
using EdgeKey = std::uint64_t;
constexpr EdgeKey edge_key(VertexId u, VertexId v) { return EdgeKey{std::min(u, v)} << 32 | std::max(u, v); }

class LineSurvey {
 public:
  struct Around {
    LabelSet labels;  // of the cells around the edge; empty if the mesh does not have the edge
    bool has_vertex_in_ball = false;  // one of these cells has another vertex in the edge's diametral ball
  };

  /// No worker may run. label_of(c) is the label of a cell.
  template <class LabelOf>
  LineSurvey(const Mesh& mesh, const LineEdges& edges, const LabelOf& label_of);

  /// Describes the surroundings of an edge of the table from u to v.
  const Around& around(VertexId u, VertexId v) const { return around_.at(edge_key(u, v)); }
  const Around& around(const LineEdge& edge) const { return around(edge.first, edge.last); }

 private:
  static void insert(LabelSet& labels, LabelIndex label) {
    const auto at = std::ranges::lower_bound(labels, label);
    if (at == labels.end() || *at != label) labels.insert(at, label);
  }

  std::unordered_map<EdgeKey, Around> around_;
};

template <class LabelOf>
LineSurvey::LineSurvey(const Mesh& mesh, const LineEdges& edges, const LabelOf& label_of) {
  std::vector<bool> is_on_line(mesh.vertex_bound());
  for (std::size_t arc = 0; arc < edges.lines().num_arcs(); ++arc)
    edges.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
      around_.try_emplace(edge_key(edge.first, edge.last));
      is_on_line[edge.first] = is_on_line[edge.last] = true;
    });
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    const auto& vertices = mesh.cell(c).vertices;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i && is_on_line[vertices[i]]; ++j) {
        if (!is_on_line[vertices[j]]) continue;
        const auto found = around_.find(edge_key(vertices[i], vertices[j]));
        if (found == around_.end()) continue;
        Around& around = found->second;
        insert(around.labels, label_of(c));
        around.has_vertex_in_ball |= std::ranges::any_of(vertices, [&](VertexId v) {
          return v != vertices[i] && v != vertices[j] &&
                 is_in_diametral_ball(mesh.point(v), mesh.point(vertices[i]), mesh.point(vertices[j]));
        });
      }
  }
}

}  // namespace podm
