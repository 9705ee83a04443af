// Local bounds on circumradii: of a size image, near interfaces, and graded from these and from the labels'
// bounds.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "sizing/scalar_grid.h"

namespace podm {

/// A bound on everything within a width of an interface. If the distances of voxels do not decide whether a
/// point is within the width, the point counts as within it. The bound therefore holds in the whole width,
/// and at most a voxel's diagonal beyond.
class NearInterface {
 public:
  /// `distances_mm` are from the nodes to the interface. `spacing_mm` is that of the nodes.
  NearInterface(ScalarGrid distances_mm, const std::array<double, 3>& spacing_mm, double width_mm,
                double radius_mm);

  double radius_mm() const { return radius_mm_; }
  bool contains(const Point& p) const;

 private:
  ScalarGrid distances_mm_;
  std::array<double, 3> spacing_mm_;
  double width_mm_, radius_mm_;
};

class SizeGrid {
 public:
  struct Image {
    ScalarGrid radius_mm;
    double factor = 1;  // applies to all radii
  };

  SizeGrid(std::optional<Image> image, std::vector<NearInterface> near, std::optional<ScalarGrid> graded,
           const Box& object);

  /// The bound at p, mm; infinity if there is none.
  double radius_at(const Point& p) const { return radius_near(p, radius_far(p)); }
  /// The bounds by image and grade alone, and by near interfaces alone if that is less than `radius_mm`.
  double radius_far(const Point& p) const {
    const double radius = image_ ? image_->factor * image_->radius_mm.at(p) : ScalarGrid::kNone;
    return graded_ ? std::min(radius, graded_->at_nearest(p)) : radius;
  }
  double radius_near(const Point& p, double radius_mm = ScalarGrid::kNone) const {
    for (const NearInterface& near : near_)
      if (near.radius_mm() < radius_mm && near.contains(p)) radius_mm = near.radius_mm();
    return radius_mm;
  }
  /// No bound in the object is smaller.
  double least_radius_mm() const { return least_mm_; }

 private:
  std::optional<Image> image_;
  std::vector<NearInterface> near_;
  std::optional<ScalarGrid> graded_;
  double least_mm_ = ScalarGrid::kNone;
};

}  // namespace podm
