#include "optimize/peel.h"

#include <algorithm>
#include <cmath>

#include "podm/bounds.h"

namespace podm {

namespace {

// The largest height as a fraction of delta. No point of an interface facet is farther than 2 delta from the
// isosurface, so this is a fortieth of the guaranteed distance. On Colin27 at 1 M cells 57 cells beyond 8 and
// 165 degrees remain if R7 moves no vertex before, 17 with 0.1 and 3 with 0.2. None remains in any case if R7
// does.
constexpr double kMostHeight = 0.05;
// Angles keep their bound in the file, too, where coordinates are rounded.
constexpr double kAngleMargin = 1 + 1e-9;

using Corners = std::array<Point, 4>;

Corners corners_of(const Mesh& mesh, CellId c) {
  const auto& v = mesh.cell(c).vertices;
  return {mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])};
}

// Returns the least distance of two parallel planes with the cell between them: one plane contains a facet
// and the other a vertex, or each contains an edge.
double height(const Corners& p) {
  const double six_volumes = std::abs(dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]));
  double most = 0;
  for (const auto& [i, j, k] : kFacetVertices) {
    const auto at = [&](int v) { return p[static_cast<unsigned>(v)]; };
    most = std::max(most, squared_length(cross(at(j) - at(i), at(k) - at(i))));
  }
  for (const unsigned edge : {0u, 1u, 2u}) {
    const auto [k, l] = kOtherVertices[edge];
    most = std::max(most, squared_length(cross(p[edge + 1] - p[0], p[l] - p[k])));
  }
  return six_volumes / std::sqrt(most);
}

bool has_good_angles(const Point& a, const Point& b, const Point& c) {
  static_assert(kFacetAngleBound ==
                30);  // see verifiers/claims/check_boundary_angles.cpp: 4 A^2 > m^2 n^2 / 4
  const double ab = squared_distance(a, b), bc = squared_distance(b, c), ca = squared_distance(c, a);
  return 4 * squared_length(cross(b - a, c - a)) > kAngleMargin * std::max({ab * bc, bc * ca, ca * ab});
}

}  // namespace

Peel::Peel(const Mesh& mesh, CellId c, LabelIndex label) {
  const LabelIndex own = mesh.label(c);
  for (unsigned k = 0; k < 4; ++k) {
    const FacetId mirror = mesh.cell(c).mirrors[k];
    const LabelIndex across = mirror == kNoFacet ? kBackground : mesh.label(cell_of(mirror));
    if (across == label) ++num_going;
    if (across == own) coming[num_coming++] = k;
  }
}

unsigned Peel::edge() const {
  const auto is_coming = [&](unsigned k) { return k == coming[0] || k == coming[1]; };
  unsigned edge = 0;
  while (!is_coming(kOtherVertices[edge][0]) || !is_coming(kOtherVertices[edge][1])) ++edge;
  return edge;
}

bool may_be_peeled(const Mesh& mesh, CellId c, const Peel& peel, double delta_mm) {
  if (peel.num_coming > std::min(peel.num_going, 2u)) return false;
  for (const VertexId v : mesh.cell(c).vertices)
    if (mesh.vertex(v).kind != VertexKind::kIsosurface) return false;
  const Corners p = corners_of(mesh, c);
  for (unsigned i = 0; i < peel.num_coming; ++i) {
    const auto& turn = kFacetVertices[peel.coming[i]];
    if (!has_good_angles(p[static_cast<unsigned>(turn[0])], p[static_cast<unsigned>(turn[1])],
                         p[static_cast<unsigned>(turn[2])]))
      return false;
  }
  return height(p) < kMostHeight * delta_mm;
}

}  // namespace podm
