#include "claims/sides_of_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace podm::verify {

namespace {

double ulp_of(double x) {
  return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x);
}

// The exact coordinate along a row of the map from voxel indices to the file.
mpq_class coordinate(const std::array<double, 12>& a, std::size_t row, const std::array<mpq_class, 3>& u) {
  mpq_class sum(a[4 * row + 3]);
  for (std::size_t axis = 0; axis < 3; ++axis) sum += mpq_class(a[4 * row + axis]) * u[axis];
  return sum;
}

std::array<double, 12> voxels_to_file(const Image& image, Space space) {
  if (space == Space::kVoxel) return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::array<double, 12> a = image.voxel_to_ras;
  if (space == Space::kLps)
    for (std::size_t i = 0; i < 8; ++i) a[i] = -a[i];
  return a;
}

}  // namespace

SidesOfVertices::SidesOfVertices(const Image& image, const ImageFrame& frame, Space space)
    : size_(image.size),
      spacing_(space == Space::kVoxel ? std::array<double, 3>{1, 1, 1} : image.spacing),
      frame_(frame),
      to_voxels_(image.voxel_to_ras, space) {
  const std::array<double, 12> a = voxels_to_file(image, space);
  // Coordinates in voxels are rounded once more, from mm.
  is_parallel_ = space != Space::kVoxel;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t count = 0;
    for (std::size_t row = 0; row < 3; ++row)
      if (a[4 * row + axis] != 0) {
        ++count;
        row_of_axis_[axis] = row;
      }
    is_parallel_ = is_parallel_ && count == 1;
  }
  double largest = 0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::array<mpq_class, 3> u;
    for (std::size_t axis = 0; axis < 3; ++axis) u[axis] = mpq_class(plane(2 * axis + (corner >> axis & 1)));
    for (std::size_t row = 0; row < 3; ++row)
      largest = std::max(largest, std::abs(coordinate(a, row, u).get_d()));
  }
  ulp_ = ulp_of(largest);
  for (std::size_t side = 0; is_parallel_ && side < kNumSides; ++side) {
    std::array<mpq_class, 3> u;
    u[axis_of(side)] = mpq_class(plane(side));
    const double at = coordinate(a, row_of_axis_[axis_of(side)], u).get_d();
    doubles_at_[side] = {std::nextafter(at, -INFINITY), std::nextafter(at, INFINITY)};
  }
}

SideSet SidesOfVertices::near(const Point& p) const {
  const Point u = frame_.to_voxels(p);
  SideSet sides = 0;
  for (std::size_t side = 0; side < kNumSides; ++side)
    if (std::abs(u[axis_of(side)] - plane(side)) < kNearSideVoxels) sides |= static_cast<SideSet>(1U << side);
  return sides;
}

double SidesOfVertices::ulps_off(const Point& p, std::size_t side, std::uint64_t& num_exact) const {
  const std::size_t axis = axis_of(side);
  if (is_parallel_) {
    const double x = p[row_of_axis_[axis]];
    const auto [low, high] = doubles_at_[side];
    return x < low ? (low - x) / ulp_of(low) : x > high ? (x - high) / ulp_of(high) : 0;
  }
  ++num_exact;
  const Vector<Rational> u = to_voxels_(Vector<Rational>{Rational(p[0]), Rational(p[1]), Rational(p[2])});
  const Rational off = u[axis] - Rational(plane(side));
  return std::abs(CGAL::to_double(off)) * spacing_[axis] / ulp_;
}

}  // namespace podm::verify
