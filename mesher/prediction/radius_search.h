// Finds the radius at which a mesh has a given number of cells. The radius is predicted from the image and
// corrected by the meshes made with it.
#pragma once

#include "prediction/cost_model.h"

namespace podm {

class RadiusSearch {
 public:
  /// `asked` gives the target, radii of single labels, and delta. A delta of 0 follows the radius; with a
  /// fixed delta the interfaces alone may exceed the target. `threads`: 0 for all cores. Throws InputError if
  /// sizes near interfaces and of single labels alone require more cells than the target, however large all
  /// other sizes are.
  RadiusSearch(const LabelImage& image, const SizeOptions& asked, int threads);

  double radius_mm() const { return radius_mm_; }
  /// The requested sizes with this radius, its delta, and the factor by which the size image's largest size
  /// becomes the radius.
  SizeOptions sizes() const { return at(radius_mm_); }
  /// Changes the radius after a mesh with the present radius had this number of cells. Returns false if it
  /// cannot: a radius larger than the image changes nothing, for example where the surfaces alone need more
  /// cells than the target.
  bool learn(double cells);

 private:
  struct Sample {
    double radius_mm, cells;
  };

  SizeOptions at(double radius_mm) const;
  double radius_for(double cells) const;

  CostModel model_;
  SizeOptions asked_;
  double largest_mm_;  // a larger radius changes nothing
  double radius_mm_ = 0;
  std::optional<Sample> too_many_, too_few_;  // the last mesh of each kind
};

}  // namespace podm
