// The radius at which a mesh has a number of cells: predicted from the image, corrected by the meshes that
// were made with it.
#pragma once

#include "cost_model.h"

namespace podm {

class RadiusSearch {
 public:
  /// Of `options`: their target, radii of single labels, and delta; where that is 0 it follows the radius, or
  /// the interfaces alone could exceed the target.
  RadiusSearch(const LabelImage& image, const MeshingOptions& options);

  double radius_mm() const { return radius_mm_; }
  double delta_mm() const { return at(radius_mm_).delta_mm; }
  /// A mesh with this radius has so many cells: changes the radius accordingly. False where it cannot: a
  /// larger radius than the image changes nothing, as where the surfaces alone take more cells than the
  /// target.
  bool learn(double cells);

 private:
  struct Sample {
    double radius_mm, cells;
  };

  MeshingOptions at(double radius_mm) const;
  double radius_for(double cells) const;

  CostModel model_;
  MeshingOptions options_;
  double largest_mm_;  // beyond it nothing changes
  double radius_mm_ = 0;
  std::optional<Sample> too_many_, too_few_;  // the last that had
};

}  // namespace podm
