#include "image/working_frame.h"

#include <algorithm>
#include <cmath>

namespace podm {
namespace {

// Larger than the error that rounding leaves in orthogonal images (checked_spacing in raw_image.h), smaller
// than that of sheared ones.
constexpr double kRounding = 1e-12;

// True if each axis of the image is parallel to one of the world.
bool is_permuted(const Affine& a) {
  for (std::size_t row = 0; row < 3; ++row)
    if ((a[4 * row] != 0) + (a[4 * row + 1] != 0) + (a[4 * row + 2] != 0) != 1) return false;
  return true;
}

bool has_own_frame(const LabelImage& image) {
  return is_sheared(image) || (image.is_box_flat && !is_permuted(image.voxel_to_ras));
}

}  // namespace

bool is_sheared(const LabelImage& image) {
  const Affine& a = image.voxel_to_ras;
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double dot = a[i] * a[j] + a[4 + i] * a[4 + j] + a[8 + i] * a[8 + j];
    worst = std::max(worst, std::fabs(dot) / (image.spacing[i] * image.spacing[j]));
  }
  return worst > kRounding;
}

Affine voxels_to_working(const LabelImage& image) {
  const auto& s = image.spacing;
  return has_own_frame(image) ? Affine{s[0], 0, 0, 0, 0, s[1], 0, 0, 0, 0, s[2], 0} : image.voxel_to_ras;
}

Affine working_to_world(const LabelImage& image) {
  if (!has_own_frame(image)) return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  Affine a = image.voxel_to_ras;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis) a[4 * row + axis] /= image.spacing[axis];
  return a;
}

}  // namespace podm
