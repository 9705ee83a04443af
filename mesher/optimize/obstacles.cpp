#include "optimize/obstacles.h"

#include <algorithm>

namespace podm {

namespace {

// Calls visit(squared cotangent, label across one facet, label across the other) for each edge of the cell at
// which two interface facets meet.
template <class Visit>
void for_each_frozen_edge(const Mesh& mesh, CellId c, const Visit& visit) {
  const Cell& cell = mesh.cell(c);
  std::array<LabelIndex, 4> across;
  std::array<Vector, 4> normals;
  std::array<Point, 4> p;
  for (unsigned k = 0; k < 4; ++k) p[k] = mesh.point(cell.vertices[k]);
  for (unsigned k = 0; k < 4; ++k) {
    across[k] = cell.mirrors[k] == kNoFacet ? kBackground : mesh.label(cell_of(cell.mirrors[k]));
    const auto at = [&](unsigned i) { return p[static_cast<unsigned>(kFacetVertices[k][i])]; };
    normals[k] = cross(at(1) - at(0), at(2) - at(0));
  }
  const LabelIndex own = mesh.label(c);
  for (const auto& [k, l] : kOtherVertices) {
    if (across[k] == own || across[l] == own) continue;
    visit(signed_square_ratio(-dot(normals[k], normals[l]), squared_length(cross(normals[k], normals[l]))),
          across[k], across[l]);
  }
}

}  // namespace

bool has_frozen_small_angle(const Mesh& mesh, CellId c, const DihedralBounds& bounds) {
  bool is_any = false;
  for_each_frozen_edge(mesh, c, [&](double cotangent2, LabelIndex, LabelIndex) {
    is_any = is_any || (cotangent2 > 0 && bounds.quality_of_angle(cotangent2) < 1);
  });
  return is_any;
}

OptimizationObstacle obstacle_of(const Mesh& mesh, CellId c, const DihedralBounds& bounds) {
  bool is_frozen = false, is_junction = false;
  for_each_frozen_edge(mesh, c, [&](double cotangent2, LabelIndex one, LabelIndex other) {
    if (bounds.quality_of_angle(cotangent2) >= 1) return;
    is_frozen = true;
    is_junction = is_junction || one != other;
  });
  if (is_junction) return OptimizationObstacle::kJunction;
  if (is_frozen) return OptimizationObstacle::kFrozenFacets;
  const auto& vertices = mesh.cell(c).vertices;
  const bool is_all = std::all_of(vertices.begin(), vertices.end(),
                                  [&](VertexId v) { return mesh.vertex(v).kind == VertexKind::kIsosurface; });
  return is_all ? OptimizationObstacle::kFrozenVertices : OptimizationObstacle::kOther;
}

}  // namespace podm
