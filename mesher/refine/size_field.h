// The size bound r_t (rule R5): one circumradius per label.
#pragma once

#include <algorithm>
#include <vector>

#include "podm/label_image.h"

namespace podm {

class SizeField {
 public:
  /// `radius_mm[label index]`; infinity where only the surface drives.
  explicit SizeField(std::vector<double> radius_mm) {
    for (const double r : radius_mm) squared_.push_back(r * r);
  }
  /// All radii times `ratio`.
  SizeField scaled(double ratio) const {
    SizeField scaled = *this;
    for (double& squared : scaled.squared_) squared *= ratio * ratio;
    return scaled;
  }
  std::size_t num_labels() const { return squared_.size(); }  // the background included
  double squared_radius(LabelIndex label) const { return squared_[label]; }
  /// The least of all labels but the background.
  double smallest_squared_radius() const { return *std::min_element(squared_.begin() + 1, squared_.end()); }

 private:
  std::vector<double> squared_;
};

}  // namespace podm
