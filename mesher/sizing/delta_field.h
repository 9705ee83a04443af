// The sampling distance of surfaces by place: a number per voxel, interpolated between voxel centers.
//
// Lipschitz: |delta(p) - delta(q)| <= kSlope |p - q|. grade() lets numbers of neighboring nodes along an axis
// differ by at most slope / graded_stretch() of the length between them. A partial derivative of the
// interpolation is a mean of such differences over the length. A gradient of three of them is at most sqrt(3)
// times as long. Beyond the grid the number is that of the nearest place in it, and the step to that place
// shortens distances.
#pragma once

#include <utility>

#include "sizing/scalar_grid.h"

namespace podm {

class DeltaField {
 public:
  static constexpr double kSlope = 0.4;
  /// Exceeds the errors of numbers in single precision, relative to a delta.
  static constexpr double kMargin = 1e-6;

  /// `deltas_mm` are Lipschitz as stated, and between `least_mm` and `most_mm`.
  DeltaField(ScalarGrid deltas_mm, double least_mm, double most_mm)
      : deltas_mm_(std::move(deltas_mm)), least_mm_(least_mm), most_mm_(most_mm) {}

  double at(const Point& p) const { return deltas_mm_.at_nearest(p); }
  double least_mm() const { return least_mm_; }
  double most_mm() const { return most_mm_; }
  /// No number of the field is smaller than this within `radius_mm` of a point with this delta.
  double least_within(double radius_mm, double delta_mm) const {
    const double least = delta_mm * (1 - kMargin) - kSlope * radius_mm;
    return least > least_mm_ ? least : least_mm_;
  }

 private:
  ScalarGrid deltas_mm_;
  double least_mm_, most_mm_;
};

}  // namespace podm
