// Affine maps of images.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "geometry/point.h"

namespace podm {

using Affine = std::array<double, 12>;  // row-major 3x4: in each row the linear part, then the translation

/// Returns the signed minor of the linear part without row r and column c.
inline double cofactor(const Affine& a, std::size_t r, std::size_t c) {
  const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
  return a[4 * r1 + c1] * a[4 * r2 + c2] - a[4 * r1 + c2] * a[4 * r2 + c1];
}

/// Returns the determinant of the linear part: the signed volume of a voxel if the map takes voxels to mm.
inline double determinant(const Affine& a) {
  return a[0] * cofactor(a, 0, 0) + a[1] * cofactor(a, 0, 1) + a[2] * cofactor(a, 0, 2);
}

/// Returns the inverse map. The determinant of `a` must not be 0.
inline Affine inverse(const Affine& a) {
  const double det = determinant(a);
  Affine b{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) b[4 * r + c] = cofactor(a, c, r) / det;
    for (std::size_t c = 0; c < 3; ++c) b[4 * r + 3] -= b[4 * r + c] * a[4 * c + 3];
  }
  return b;
}

inline Point map(const Affine& a, const Point& p) {
  const auto row = [&](std::size_t r) { return a[r] * p.x + a[r + 1] * p.y + a[r + 2] * p.z + a[r + 3]; };
  return {row(0), row(4), row(8)};
}
/// The same, with an error below one unit in the last place of the largest term: rounding errors are summed
/// apart (Ogita, Rump and Oishi, "Accurate sum and dot product", SIAM J. Sci. Comput. 26 (2005), Dot2).
inline Point map_accurately(const Affine& a, const Point& p) {
  const auto row = [&](std::size_t r) {
    double sum = a[r + 3], errors = 0;
    for (const auto& [factor, x] :
         {std::pair(a[r], p.x), std::pair(a[r + 1], p.y), std::pair(a[r + 2], p.z)}) {
      const double product = factor * x, next = sum + product, part = next - sum;
      errors += std::fma(factor, x, -product) + ((sum - (next - part)) + (product - part));
      sum = next;
    }
    return sum + errors;
  };
  return {row(0), row(4), row(8)};
}
inline std::array<double, 3> map(const Affine& a, const std::array<double, 3>& x) {
  const Point y = map(a, Point{x[0], x[1], x[2]});
  return {y.x, y.y, y.z};
}

}  // namespace podm
