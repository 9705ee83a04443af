// The facets and cells near lines: those with a vertex on a line, which is the end of an edge of the line
// with three labels around it. A vertex that has lost all such edges counts as any other vertex of the
// isosurface at the end of a run (algorithms/sample_lines.h).
#pragma once

#include <algorithm>
#include <array>
#include <numbers>

#include "delaunay/mesh.h"

namespace podm {

/// Near lines R3 applies to facets whose circumradius is at least this many sides, which is an angle of at
/// most 20.7 degrees: see rules.h.
inline constexpr double kNearLinesRatio = std::numbers::sqrt2;

/// True if the facet with this local index of a cell with these vertices is near a line.
template <class Cells>
bool is_near_lines(const Cells& cells, const std::array<VertexId, 4>& vertices, unsigned facet) {
  return std::ranges::any_of(kFacetVertices[facet], [&](int i) {
    return cells.vertex(vertices[static_cast<unsigned>(i)]).kind == VertexKind::kLine;
  });
}

}  // namespace podm
