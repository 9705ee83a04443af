#include "delaunay/walk.h"

#include "geometry/predicates.h"

namespace podm {

CellId next_towards(const Mesh& mesh, const Point& p, CellId c, CellId previous) {
  const Cell& cell = mesh.cell(c);
  for (unsigned k = 0; k < 4; ++k) {
    if (cell.mirrors[k] == kNoFacet || cell_of(cell.mirrors[k]) == previous) continue;
    const auto point = [&](unsigned i) {
      return mesh.point(cell.vertices[static_cast<unsigned>(kFacetVertices[k][i])]);
    };
    if (orientation(point(0), point(1), point(2), p) < 0) return cell_of(cell.mirrors[k]);
  }
  return c;
}

CellId cell_with(const Mesh& mesh, const Point& p, CellId from) {
  for (CellId previous = from;;) {
    const CellId next = next_towards(mesh, p, from, previous);
    if (next == from) return from;
    previous = from;
    from = next;
  }
}

void find_around_vertex(Mesh& mesh, VertexId v, CellId c, std::vector<CellId>& ball) {
  ball.clear();
  const auto add = [&](CellId each) {
    if (mesh.is_marked(each)) return;
    mesh.mark(each, true);
    ball.push_back(each);
  };
  add(c);
  for (std::size_t i = 0; i < ball.size(); ++i) {
    const Cell& cell = mesh.cell(ball[i]);
    for (unsigned k = 0; k < 4; ++k)
      if (cell.vertices[k] != v && cell.mirrors[k] != kNoFacet) add(cell_of(cell.mirrors[k]));
  }
  for (const CellId each : ball) mesh.mark(each, false);
}

}  // namespace podm
