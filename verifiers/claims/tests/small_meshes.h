// Small meshes for the tests of the geometric claims.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "claims/claims.h"
#include "claims/tests/meshed_voxels.h"
#include "geometry/exact.h"

namespace podm::verify {

inline Mesh mesh_of(std::vector<Point> vertices, std::vector<std::array<VertexId, 4>> cells) {
  Mesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.cells = std::move(cells);
  return mesh;
}

/// Returns Kuhn's six tetrahedra in each of size^3 unit cubes; half of the cubes have label 2.
inline Mesh kuhn_cubes(int size) {
  return kuhn_mesh(
      make_image({size, size, size}, kUnitAffine, [&](int i, int, int) { return 2 * i < size ? 1 : 2; }));
}

/// Returns a cell of the origin and a point on each axis. Its circumradius is sqrt(a^2 + b^2 + c^2) / 2, its
/// shortest edge min(a, b, c).
inline Mesh corner(double a, double b, double c) {
  return mesh_of({{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}}, {{0, 1, 2, 3}});
}

/// Returns two cells on the facet 0 1 2, with the far vertices (0, 0, 1) and `below`.
inline Mesh two_cells(const Point& below = {0, 0, -1}) {
  return mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, below}, {{0, 1, 2, 3}, {0, 2, 1, 4}});
}

inline Mesh joined(Mesh a, const Mesh& b) {
  const auto base = static_cast<VertexId>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& cell : b.cells)
    a.cells.push_back({cell[0] + base, cell[1] + base, cell[2] + base, cell[3] + base});
  return a;
}

inline Mesh shifted(Mesh mesh, const Point& by) {
  for (Point& p : mesh.vertices)
    for (std::size_t a = 0; a < 3; ++a) p[a] += by[a];
  return mesh;
}

inline Mesh turned_over(Mesh mesh) {
  for (auto& cell : mesh.cells) std::swap(cell[0], cell[1]);
  return mesh;
}

/// Returns points of small integer coordinates, so that degenerate positions are frequent.
inline std::vector<Point> lattice_points(std::size_t count, int size, std::mt19937& random) {
  std::uniform_int_distribution<int> coordinate(0, size);
  std::vector<Point> points(count);
  for (Point& p : points)
    for (double& x : p) x = coordinate(random);
  return points;
}

inline int rational_orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  return static_cast<int>(CGAL::sign(
      dot(cross(difference<Rational>(b, a), difference<Rational>(c, a)), difference<Rational>(d, a))));
}

/// Returns the result of side_of_sphere(), computed from the center and the radius in rationals.
inline int rational_side_of_sphere(const std::array<Point, 4>& cell, const Point& p) {
  const auto a = difference<Rational>(cell[0], cell[3]), b = difference<Rational>(cell[1], cell[3]),
             c = difference<Rational>(cell[2], cell[3]), x = difference<Rational>(p, cell[3]);
  const auto bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const Rational twice = Rational(2) * dot(a, bc);
  Vector<Rational> center;
  for (std::size_t i = 0; i < 3; ++i)
    center[i] = (dot(a, a) * bc[i] + dot(b, b) * ca[i] + dot(c, c) * ab[i]) / twice;
  const Vector<Rational> to_x{x[0] - center[0], x[1] - center[1], x[2] - center[2]};
  return static_cast<int>(CGAL::compare(dot(center, center), dot(to_x, to_x)));
}

/// Returns the Delaunay tetrahedra of points, found by trying all. No five points may be on an empty sphere.
inline Mesh delaunay_by_force(const std::vector<Point>& points) {
  Mesh mesh = mesh_of(points, {});
  const auto n = static_cast<VertexId>(points.size());
  const auto is_empty = [&](const std::array<VertexId, 4>& v) {
    for (VertexId x = 0; x < n; ++x)
      if (std::find(v.begin(), v.end(), x) == v.end() &&
          rational_side_of_sphere({points[v[0]], points[v[1]], points[v[2]], points[v[3]]}, points[x]) > 0)
        return false;
    return true;
  };
  for (VertexId a = 0; a < n; ++a)
    for (VertexId b = a + 1; b < n; ++b)
      for (VertexId c = b + 1; c < n; ++c)
        for (VertexId d = c + 1; d < n; ++d) {
          const int turn = rational_orientation(points[a], points[b], points[c], points[d]);
          if (turn == 0 || !is_empty({a, b, c, d})) continue;
          mesh.cells.push_back(turn > 0 ? std::array{a, b, c, d} : std::array{b, a, c, d});
        }
  return mesh;
}

inline std::vector<Point> random_points(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<Point> points(count);
  for (Point& p : points)
    for (double& x : p) x = coordinate(random);
  return points;
}

inline Options two_threads() {
  Options options;
  options.threads = 2;
  return options;
}

inline ClaimResult structure_of(const Mesh& mesh, int threads = 2) {
  Options options;
  options.threads = threads;
  return check_structure(mesh, find_adjacency(mesh, 2), options);
}

inline ClaimResult delaunay_of(const Mesh& mesh, int threads = 2) {
  Options options;
  options.threads = threads;
  return check_delaunay(mesh, find_adjacency(mesh, 2), options);
}

inline bool names(const ClaimResult& result, const std::string& statement) {
  return std::any_of(result.worst.begin(), result.worst.end(),
                     [&](const Witness& witness) { return witness.statement == statement; });
}

}  // namespace podm::verify
