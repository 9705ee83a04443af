// The consistency of the table of edges of lines.
#pragma once

#include <cmath>
#include <string>

#include "podm/errors.h"
#include "refine/line_edges.h"

namespace podm::test {

/// Returns a fault of the table, or an empty string. The edges of an arc must cover it, both ends of an edge
/// must have it, and their vertices must be on a line or have lost it.
inline std::string fault_of_table(const LineEdges& edges, const Mesh& mesh) {
  std::string fault;
  for (std::size_t arc = 0; arc < edges.lines().num_arcs() && fault.empty(); ++arc) {
    double length_mm = 0;
    std::size_t count = 0;
    edges.for_each_edge_of_arc(arc, [&](const LineEdge& edge) {
      if (++count > mesh.vertex_bound()) throw InternalError("the edges of an arc do not end");
      length_mm += edges.length(edge);
      for (const VertexId v : {edge.first, edge.last}) {
        bool is_found = false;
        edges.for_each_edge_of(v, [&](const LineEdge& of) { is_found = is_found || of.is_same(edge); });
        const VertexKind kind = mesh.vertex(v).kind;
        if (!is_found || (kind != VertexKind::kLine && kind != VertexKind::kPinned))
          fault = "an end does not have its edge";
      }
    });
    if (count > 0 && std::abs(length_mm - edges.lines().arc(arc).length()) > 1e-9 * length_mm)
      fault = "the edges of an arc do not cover it";
  }
  return fault;
}

}  // namespace podm::test
