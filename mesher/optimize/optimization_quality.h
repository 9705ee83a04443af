// The quality that optimisation improves, a cell's worst dihedral angle, and the bounds on ratio and size
// that it must keep.
#pragma once

#include "geometry/circumsphere.h"
#include "geometry/dihedral.h"
#include "podm/bounds.h"
#include "sizing/size_field.h"

namespace podm {

/// A cell's points; the cell is positive (geometry/tetrahedron.h).
struct CellPoints {
  Point a, b, c, d;

  DihedralExtremes dihedral() const { return dihedral_extremes(a, b, c, d); }
};

class OptimizationQuality {
 public:
  /// A cell at these bounds has a quality of 1.
  explicit OptimizationQuality(const DihedralBounds& bounds) : bounds_(bounds) {}
  const DihedralBounds& bounds() const { return bounds_; }

  /// Returns DihedralBounds::quality.
  double of(const CellPoints& p) const { return bounds_.quality(p.dihedral()); }
  /// Returns the same for a cell that keeps the bounds on ratio and circumradius, in rounded arithmetic with
  /// a margin, and 0 for a cell that does not.
  double of_new(const CellPoints& p, const LabelBound& bound) const {
    const Vector e1 = p.a - p.d, e2 = p.b - p.d, e3 = p.c - p.d;
    const double s1 = squared_length(e1), s2 = squared_length(e2), s3 = squared_length(e3);
    const double shortest2 = std::min(
        {s1, s2, s3, squared_distance(p.a, p.b), squared_distance(p.a, p.c), squared_distance(p.b, p.c)});
    const Vector to_center = relative_sphere(e1, e2, e3, s1, s2, s3).center;
    const double radius2 = squared_length(to_center);
    // The radius is not a number if the cell is flat.
    if (!(radius2 <
          kMargin * std::min(kRadiusEdgeBound * kRadiusEdgeBound * shortest2, bound.most_squared())))
      return 0;
    if (!bound.allows(radius2, p.d + to_center)) return 0;
    return of(p);
  }

 private:
  // Far above the rounding errors of output coordinates, and of the circumradius of a cell with a good angle.
  static constexpr double kMargin = 1 - 1e-9;

  DihedralBounds bounds_;
};

}  // namespace podm
