// Squared measures of cells and triangles as fractions, over any field.
#pragma once

#include <array>

#include "geometry/exact.h"

namespace podm::verify {

inline constexpr std::array<std::array<int, 2>, 6> kEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

using CellPoints = std::array<Point, 4>;
using TrianglePoints = std::array<Point, 3>;

inline CellPoints points_of(const Mesh& mesh, CellId c) {
  const auto& v = mesh.cells[c];
  return {mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]], mesh.vertices[v[3]]};
}

inline TrianglePoints points_of(const Mesh& mesh, const std::array<VertexId, 3>& v) {
  return {mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
}

template <class T>
T squared_length(const Point& a, const Point& b) {
  const Vector<T> d = difference<T>(a, b);
  return dot(d, d);
}

/// numerator / denominator. The denominator is not negative; it is 0 for a flat cell or triangle.
template <class T>
struct Fraction {
  T numerator, denominator;
};

/// Returns R^2 of a cell: with e_i the edges from its last vertex,
/// |sum |e_i|^2 e_j x e_k|^2 / (2 e1.(e2 x e3))^2.
template <class T>
Fraction<T> squared_circumradius(const CellPoints& p) {
  const Vector<T> a = difference<T>(p[0], p[3]), b = difference<T>(p[1], p[3]), c = difference<T>(p[2], p[3]);
  const Vector<T> bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const T a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c), det = dot(a, bc);
  const Vector<T> sum{a2 * bc[0] + b2 * ca[0] + c2 * ab[0], a2 * bc[1] + b2 * ca[1] + c2 * ab[1],
                      a2 * bc[2] + b2 * ca[2] + c2 * ab[2]};
  return {dot(sum, sum), T(4) * det * det};
}

template <class T>
T squared_shortest_edge(const CellPoints& p) {
  T least = squared_length<T>(p[0], p[1]);
  for (const auto& [i, j] : kEdges)
    least =
        smaller<T>(least, squared_length<T>(p[static_cast<std::size_t>(i)], p[static_cast<std::size_t>(j)]));
  return least;
}

/// Returns 4 area^2 of a triangle.
template <class T>
T squared_double_area(const TrianglePoints& p) {
  const Vector<T> normal = cross(difference<T>(p[1], p[0]), difference<T>(p[2], p[0]));
  return dot(normal, normal);
}

double radius_edge_ratio(const CellPoints& p);                   ///< rounded; infinite for a flat cell
double circumradius(const CellPoints& p);                        ///< rounded
std::array<double, 3> angles_deg(const TrianglePoints& p);       ///< rounded
std::array<double, 6> dihedral_angles_deg(const CellPoints& p);  ///< rounded

}  // namespace podm::verify
