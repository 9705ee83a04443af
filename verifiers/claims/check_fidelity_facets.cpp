#include "claims/check_fidelity_facets.h"

#include <cmath>

#include "claims/check_surface_boundary.h"
#include "geometry/exact.h"
#include "parallel.h"
#include "ranks/part.h"

namespace podm::verify {

namespace {

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point plus(const Point& a, double s, const Point& d) {
  return {a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2]};
}

}  // namespace

InterfaceFacets::InterfaceFacets(const Mesh& mesh, const Adjacency& adjacency, const ImageFrame& frame,
                                 int threads)
    : frame_(frame), points_(mesh.vertices.size()) {
  parallel_ranges(points_.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) points_[i] = frame.to_world(mesh.vertices[i]);
  });
  const CellLabelIndices label_indices(mesh);
  for (const Side& side : find_sides(mesh, adjacency, label_indices, threads))
    if (side.across < side.label && owns_cell(mesh, side.cell))
      facets_.push_back(
          {side.vertices, {label_indices.labels[side.label], label_indices.labels[side.across]}, side.cell});
}

std::array<Point, 3> InterfaceFacets::triangle(std::uint32_t i) const {
  const auto& v = facets_[i].vertices;
  return {points_[v[0]], points_[v[1]], points_[v[2]]};
}

void InterfaceFacets::bounds(std::uint32_t i, Point& low, Point& high) const {
  const auto t = triangle(i);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::min({t[0][axis], t[1][axis], t[2][axis]});
    high[axis] = std::max({t[0][axis], t[1][axis], t[2][axis]});
  }
}

double InterfaceFacets::area(std::uint32_t i) const {
  const auto t = triangle(i);
  const Point n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  return 0.5 * std::sqrt(dot(n, n));
}

// The point lies in the region of a vertex, of an edge or of the inside: Ericson, "Real-Time Collision
// Detection" (2005), 5.1.5.
Point InterfaceFacets::closest(std::uint32_t i, const Point& p) const {
  const auto [a, b, c] = triangle(i);
  const Point ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Point bp = minus(p, b);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return plus(a, d1 / (d1 - d3), ab);
  const Point cp = minus(p, c);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return plus(a, d2 / (d2 - d6), ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return plus(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b));
  const double sum = va + vb + vc;
  return plus(plus(a, vb / sum, ab), vc / sum, ac);
}

int InterfaceFacets::num_parts(const std::array<Point, 3>& t) const {
  constexpr double kMostParts = 8192;
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point d = frame_.world_to_voxels_vector(minus(t[(i + 1) % 3], t[i]));
    longest = std::max(longest, std::sqrt(dot(d, d)));
  }
  return static_cast<int>(std::floor(std::min(2 * longest, kMostParts))) + 1;
}

}  // namespace podm::verify
