#include "values/grid_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace podm {

namespace {

using ExactAffine = std::array<Rational, 12>;

Rational cofactor_of(const ExactAffine& a, std::size_t r, std::size_t c) {
  const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
  return a[4 * r1 + c1] * a[4 * r2 + c2] - a[4 * r1 + c2] * a[4 * r2 + c1];
}

Rational determinant_of(const ExactAffine& a) {
  return a[0] * cofactor_of(a, 0, 0) + a[1] * cofactor_of(a, 0, 1) + a[2] * cofactor_of(a, 0, 2);
}

}  // namespace

ExactAffine exact_affine(const Affine& affine) {
  ExactAffine exact;
  std::copy(affine.begin(), affine.end(), exact.begin());
  return exact;
}

ExactAffine exact_inverse(const ExactAffine& a) {
  const Rational det = determinant_of(a);
  ExactAffine b;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) b[4 * r + c] = cofactor_of(a, c, r) / det;
    for (std::size_t c = 0; c < 3; ++c) b[4 * r + 3] -= b[4 * r + c] * a[4 * c + 3];
  }
  return b;
}

ExactAffine product(const ExactAffine& a, const ExactAffine& b) {
  ExactAffine c;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t col = 0; col < 4; ++col)
      for (std::size_t n = 0; n < 3; ++n) c[4 * r + col] += a[4 * r + n] * b[4 * n + col];
    c[4 * r + 3] += a[4 * r + 3];
  }
  return c;
}

GridFrame::GridFrame(const ExactAffine& grid_to_mesh, int parts)
    : mesh_to_grid_(exact_inverse(grid_to_mesh)), keeps_orientation_(determinant_of(grid_to_mesh) > 0) {
  for (const std::size_t translation : {3u, 7u, 11u}) mesh_to_grid_[translation] += Rational(1, 2);
  for (std::size_t i = 0; i < 12; ++i) {
    mesh_to_grid_[i] *= parts;
    high_[i] = static_cast<double>(mesh_to_grid_[i]);
    low_[i] = static_cast<double>(Rational(mesh_to_grid_[i] - Rational(high_[i])));
  }
}

GridPoint<Rational> GridFrame::exact(const std::array<double, 3>& vertex) const {
  GridPoint<Rational> point;
  for (std::size_t r = 0; r < 3; ++r) {
    point[r] = mesh_to_grid_[4 * r + 3];
    for (std::size_t c = 0; c < 3; ++c) point[r] += mesh_to_grid_[4 * r + c] * Rational(vertex[c]);
  }
  return point;
}

// Rounding errors are summed apart, as in map_accurately().
GridFrame::Sum GridFrame::map_row(std::size_t axis, const std::array<double, 3>& vertex) const {
  Sum sum{high_[4 * axis + 3], low_[4 * axis + 3]};
  for (std::size_t c = 0; c < 3; ++c) {
    const double factor = high_[4 * axis + c], x = vertex[c];
    const double term = factor * x, next = sum.high + term, part = next - sum.high;
    sum.low +=
        std::fma(factor, x, -term) + ((sum.high - (next - part)) + (term - part)) + low_[4 * axis + c] * x;
    sum.high = next;
  }
  return sum;
}

LocalCorners<double> GridFrame::local(const std::array<std::array<double, 3>, 4>& cell) const {
  constexpr double kMost = 1 << 30;
  LocalCorners<double> local;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<Sum, 4> sums;
    double least = kMost;
    for (std::size_t n = 0; n < 4; ++n) {
      sums[n] = map_row(axis, cell[n]);
      least = std::min(least, sums[n].high);
    }
    const double origin = std::floor(std::max(least, -kMost));
    local.origin[axis] = static_cast<int>(origin);
    for (std::size_t n = 0; n < 4; ++n)
      local.corners[n][axis] = std::clamp((sums[n].high - origin) + sums[n].low, -kMost, kMost);
  }
  return local;
}

}  // namespace podm
