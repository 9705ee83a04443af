// The radius at which a mesh has a number of cells: predicted from the image, corrected by the meshes that
// were made with it.
#pragma once

#include "prediction/cost_model.h"

namespace podm {

class RadiusSearch {
 public:
  /// `asked` gives the target, radii of single labels, and delta; where that is 0 it follows the radius, or
  /// the interfaces alone could exceed the target. `threads`: 0 for all cores. Throws InputError where sizes
  /// near interfaces and of single labels ask for more cells, however large all others are.
  RadiusSearch(const LabelImage& image, const SizeOptions& asked, int threads);

  double radius_mm() const { return radius_mm_; }
  /// What was asked for, with this radius, its delta, and the factor by which it is the size image's largest.
  SizeOptions sizes() const { return at(radius_mm_); }
  /// A mesh with this radius has so many cells: changes the radius accordingly. False where it cannot: a
  /// larger radius than the image changes nothing, as where the surfaces alone take more cells than the
  /// target.
  bool learn(double cells);

 private:
  struct Sample {
    double radius_mm, cells;
  };

  SizeOptions at(double radius_mm) const;
  double radius_for(double cells) const;

  CostModel model_;
  SizeOptions asked_;
  double largest_mm_;  // beyond it nothing changes
  double radius_mm_ = 0;
  std::optional<Sample> too_many_, too_few_;  // the last that had
};

}  // namespace podm
