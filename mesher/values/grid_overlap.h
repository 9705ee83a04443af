// The moments of a tetrahedron over each voxel of a grid that it overlaps.
//
// Voxel (i,j,k) is the cube [i,i+1] x [j,j+1] x [k,k+1]. Let f be a field that is continuous in the voxel,
// and F(x,y,z) the integral of f(s,y,z) over those s below x that are in the voxel. F is 0 below the voxel
// and does not depend on x above it; dF/dx is f in the voxel and 0 elsewhere. By the divergence theorem,
// applied to the part of the tetrahedron in the column of the voxel, the integral of f over the overlap is
// the sum of F n_x over the parts of the facets in that column. So only facets are cut by the planes of the
// grid. The part of a facet in a voxel adds to that voxel and, through F above the voxel, to all voxels below
// it in x.
//
// Real is double, or a type of more precise or of exact numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace podm {

/// A point in voxels.
template <class Real>
using GridPoint = std::array<Real, 3>;

/// The field 1: its integral over a part is the volume of the part.
struct ConstantField {
  static constexpr std::size_t kMoments = 1;
};

/// The fields 1, x, y, xy, z, xz, yz, xyz, measured from the lowest corner of the voxel: their integrals
/// determine that of any trilinear field.
struct TrilinearField {
  static constexpr std::size_t kMoments = 8;
};

template <class Real>
int floor_of(const Real& x) {
  using std::floor;
  return static_cast<int>(floor(x));
}

/// The largest relative error of one operation; 0 for exact numbers.
template <class Real>
double unit_roundoff() {
  return std::numeric_limits<Real>::is_exact ? 0
                                             : static_cast<double>(std::numeric_limits<Real>::epsilon()) / 2;
}

/// A convex polygon in a plane, with up to nine corners: a triangle that has been cut by six planes.
template <class Real>
class CutFacet {
 public:
  CutFacet() = default;
  CutFacet(const GridPoint<Real>& a, const GridPoint<Real>& b, const GridPoint<Real>& c)
      : corners_{a, b, c}, size_(3) {}

  std::size_t size() const { return size_; }
  const GridPoint<Real>& operator[](std::size_t i) const { return corners_[i]; }

  Real least(std::size_t axis) const {
    Real least = corners_[0][axis];
    for (std::size_t i = 1; i < size_; ++i) least = std::min(least, corners_[i][axis]);
    return least;
  }
  bool reaches_above(std::size_t axis, int plane) const {
    for (std::size_t i = 0; i < size_; ++i)
      if (corners_[i][axis] > plane) return true;
    return false;
  }

  /// Cuts off and returns the part below the plane; if it has no area, less than three corners.
  CutFacet take_below(std::size_t axis, int plane) {
    if (!reaches_above(axis, plane)) {
      CutFacet all = *this;
      size_ = 0;
      return all;
    }
    CutFacet below, above;
    for (std::size_t i = 0; i < size_; ++i) {
      const GridPoint<Real>& here = corners_[i];
      const GridPoint<Real>& next = corners_[i + 1 < size_ ? i + 1 : 0];
      if (!(here[axis] > plane)) below.add(here);
      if (!(here[axis] < plane)) above.add(here);
      if ((here[axis] < plane && next[axis] > plane) || (here[axis] > plane && next[axis] < plane)) {
        const GridPoint<Real> crossing = cut_edge(here, next, axis, plane);
        below.add(crossing);
        above.add(crossing);
      }
    }
    *this = above;
    return below;
  }

  /// Calls visit(slab, part) for the part in each slab [s, s+1] of the axis. A polygon in a plane between two
  /// slabs is in one of them.
  template <class Visit>
  void for_each_slab(std::size_t axis, const Visit& visit) const {
    int slab = floor_of(least(axis));
    CutFacet rest = *this;
    for (; rest.reaches_above(axis, slab + 1); ++slab)
      if (const CutFacet below = rest.take_below(axis, slab + 1); below.size_ >= 3) visit(slab, below);
    if (rest.size_ >= 3) visit(slab, rest);
  }

 private:
  void add(const GridPoint<Real>& corner) { corners_[size_++] = corner; }

  // Both facets of an edge find the same point, as it is computed from the lower end.
  static GridPoint<Real> cut_edge(const GridPoint<Real>& a, const GridPoint<Real>& b, std::size_t axis,
                                  int plane) {
    const GridPoint<Real>& low = a[axis] < b[axis] ? a : b;
    const GridPoint<Real>& high = a[axis] < b[axis] ? b : a;
    const Real share = (plane - low[axis]) / (high[axis] - low[axis]);
    GridPoint<Real> point;
    for (std::size_t i = 0; i < 3; ++i) point[i] = low[i] + share * (high[i] - low[i]);
    point[axis] = plane;
    return point;
  }

  std::array<GridPoint<Real>, 9> corners_;
  std::size_t size_ = 0;
};

/// Computes the moments of one tetrahedron after the other.
template <class Real, class Field>
class GridOverlap {
 public:
  using Moments = std::array<Real, Field::kMoments>;

  /// Calls visit({i,j,k}, moments) for each voxel in the bounding box of the tetrahedron. The corners are
  /// positively oriented. Voxels that it does not meet have moments of 0, except for rounding.
  template <class Visit>
  void operator()(const std::array<GridPoint<Real>, 4>& corners, const Visit& visit) {
    bound(corners);
    std::array<CutFacet<Real>, 4> facets;
    for (std::size_t n = 0; n < 4; ++n)
      facets[n] = {corners[kFacets[n][0]], corners[kFacets[n][1]], corners[kFacets[n][2]]};
    for (int k = first_[2]; k < first_[2] + size_[2]; ++k) {
      std::fill(sums_.begin(), sums_.end(), Sums{});
      for (CutFacet<Real>& facet : facets)
        if (const CutFacet<Real> layer = facet.take_below(2, k + 1); layer.size() >= 3) add_layer(k, layer);
      for (int j = first_[1]; j < first_[1] + size_[1]; ++j) sum_row(j, k, visit);
    }
  }

  /// A bound on the sum, over all voxels, of the rounding errors in the last tetrahedron's volumes, if its
  /// corners were exact; 0 for exact numbers.
  double volume_error() const { return error_; }

 private:
  // Seen from outside, the corners of each facet are counterclockwise if the tetrahedron is positively
  // oriented.
  static constexpr std::size_t kFacets[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  static constexpr bool kIsRounded = !std::numeric_limits<Real>::is_exact;
  // The moments of 1, y, z and yz over a part of a facet, projected along x.
  static constexpr std::size_t kProjected = Field::kMoments == 1 ? 1 : 4;
  using Projected = std::array<Real, kProjected>;
  // The parts of facets in a voxel add moments of u and u^2/2 times these fields to the voxel, where u is x
  // above its lower face, and moments of the fields to the voxels below in x.
  struct Sums {
    Projected of_u{}, of_u2{}, below{};
  };

  void bound(const std::array<GridPoint<Real>, 4>& corners) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [low, high] =
          std::minmax({corners[0][axis], corners[1][axis], corners[2][axis], corners[3][axis]});
      first_[axis] = floor_of(low);
      size_[axis] = floor_of(high) - first_[axis] + 1;
    }
    sums_.resize(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]));
    error_ = 0;
  }

  Sums* row(int j) {
    return sums_.data() + static_cast<std::size_t>(j - first_[1]) * static_cast<std::size_t>(size_[0]);
  }

  void add_layer(int k, const CutFacet<Real>& layer) {
    layer.for_each_slab(1, [&](int j, const CutFacet<Real>& in_row) {
      in_row.for_each_slab(0, [&](int i, const CutFacet<Real>& part) { add_part(i, j, k, part); });
    });
  }

  void add_part(int i, int j, int k, const CutFacet<Real>& part) {
    Sums& sums = row(j)[i - first_[0]];
    const auto local = [&](std::size_t n) {
      return GridPoint<Real>{part[n][0] - i, part[n][1] - j, part[n][2] - k};
    };
    const GridPoint<Real> a = local(0);
    GridPoint<Real> b = local(1);
    for (std::size_t n = 2; n < part.size(); ++n) {
      const GridPoint<Real> c = local(n);
      const Real area = ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])) / 2;
      if constexpr (kIsRounded)
        error_ += kRoundingsOfTerm * unit_roundoff<Real>() * std::abs(static_cast<double>(area)) *
                  (i - first_[0] + 1);
      add_triangle(area, {a, b, c}, sums);
      b = c;
    }
  }

  static void add_triangle(const Real& area, const std::array<GridPoint<Real>, 3>& corners, Sums& sums) {
    if constexpr (Field::kMoments == 1) {
      sums.below[0] += area;
      sums.of_u[0] += area * (corners[0][0] + corners[1][0] + corners[2][0]) / 3;
    } else {
      add_quadrature(area, corners, sums);
    }
  }

  // The integrands are polynomials of degree 4. This rule (Grundmann and Moeller, SIAM J. Numer. Anal. 15
  // (1978) 282-290, s = 2) is exact to degree 5, and its points and weights are rational.
  static void add_quadrature(const Real& area, const std::array<GridPoint<Real>, 3>& corners, Sums& sums) {
    for (const RulePoint& at : kRule) {
      GridPoint<Real> p;
      for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] = (at.a * corners[0][axis] + at.b * corners[1][axis] + at.c * corners[2][axis]) / at.of;
      const Real part = area * at.weight / at.over;
      const Projected fields = {part, part * p[1], part * p[2], part * p[1] * p[2]};
      for (std::size_t n = 0; n < kProjected; ++n) {
        sums.below[n] += fields[n];
        sums.of_u[n] += fields[n] * p[0];
        sums.of_u2[n] += fields[n] * p[0] * p[0] / 2;
      }
    }
  }

  // Voxels from the highest x on, so that all parts above a voxel are summed before it.
  template <class Visit>
  void sum_row(int j, int k, const Visit& visit) {
    const Sums* const sums = row(j);
    Projected above{};
    for (int i = size_[0] - 1; i >= 0; --i) {
      Moments moments;
      for (std::size_t n = 0; n < kProjected; ++n) {
        moments[(Field::kMoments > 1 ? 2 : 1) * n] = sums[i].of_u[n] + above[n];
        if constexpr (Field::kMoments > 1) moments[2 * n + 1] = sums[i].of_u2[n] + above[n] / 2;
        above[n] += sums[i].below[n];
      }
      visit(std::array<int, 3>{i + first_[0], j, k}, moments);
    }
  }

  // The point with barycentric coordinates a/of, b/of, c/of has the weight weight/over times the area.
  struct RulePoint {
    int a, b, c, of, weight, over;
  };
  static constexpr RulePoint kRule[] = {
      {5, 1, 1, 7, 2401, 5760}, {1, 5, 1, 7, 2401, 5760}, {1, 1, 5, 7, 2401, 5760}, {3, 3, 1, 7, 2401, 5760},
      {3, 1, 3, 7, 2401, 5760}, {1, 3, 3, 7, 2401, 5760}, {3, 1, 1, 5, -625, 1152}, {1, 3, 1, 5, -625, 1152},
      {1, 1, 3, 5, -625, 1152}, {1, 1, 1, 3, 81, 640}};
  // Roundings of an area from exact corners, of a sum of up to a thousand of them, and of their u.
  static constexpr double kRoundingsOfTerm = 64;

  std::array<int, 3> first_{}, size_{};  // of the bounding box, in voxels
  std::vector<Sums> sums_;               // of one layer
  double error_ = 0;
};

}  // namespace podm
