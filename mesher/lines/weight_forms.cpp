#include "lines/weight_forms.h"

#include <algorithm>

namespace podm {

WeightForms::WeightForms(const BlockCorners& corners) {
  std::array<LabelIndex, 8> sorted = corners.labels;
  std::sort(sorted.begin(), sorted.end());
  size_ = static_cast<std::size_t>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
  std::copy_n(sorted.begin(), size_, labels_.begin());
  for (std::size_t c = 0; c < 8; ++c) corners_[slot(corners.labels[c])][c] = corners.weights[c];
}

Trilinear WeightForms::form(std::size_t slot) const {
  CornerValues values;
  std::copy(corners_[slot].begin(), corners_[slot].end(), values.begin());
  return Trilinear(values);
}

double WeightForms::weight(std::size_t slot, const Point& f) const { return form(slot).value(f); }

WeightForms forms_on_face(const BlockCorners& corners, std::size_t axis, bool is_upper) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  BlockCorners face;
  for (std::size_t c = 0; c < 8; ++c) {
    const std::size_t of_block = (c & 1) << u | (c >> 1 & 1) << v | std::size_t{is_upper} << axis;
    face.labels[c] = corners.labels[of_block];
    face.weights[c] = corners.weights[of_block];
  }
  return WeightForms(face);
}

}  // namespace podm
