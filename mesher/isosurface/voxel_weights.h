// The weight of each voxel in the smoothed label function. It is about proportional to the distance from the
// voxel's center to the smoothed interface.
//
// The weight of a label at a point is the trilinear interpolation of the weights of its voxels, with 0 at all
// other voxels. Between two neighbors of different labels, of weights a and b, the label changes at a/(a+b)
// of the way: halfway where all weights are equal, as in an image that is not smoothed. A voxel's center
// keeps its label, whatever the weights. So does the segment between neighbors of one label. No component of
// a label (by faces) is therefore ever lost, split or joined to another along an axis.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "isosurface/isosurface_block.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

/// Voxel weights in (0,1], set for voxels beside one of another label and unset elsewhere. They take two
/// bytes per voxel.
class VoxelWeights {
 public:
  static constexpr std::uint16_t kMost = 0xffff, kUnset = 0;

  /// All weights are unset at first.
  explicit VoxelWeights(const std::array<int, 3>& size)
      : size_(size),
        row_(static_cast<std::size_t>(size[0])),
        slice_(row_ * static_cast<std::size_t>(size[1])),
        weights_(slice_ * static_cast<std::size_t>(size[2])) {}

  /// In units of 1 / kMost.
  std::uint16_t& at(std::size_t voxel) { return weights_[voxel]; }
  std::uint16_t at(std::size_t voxel) const { return weights_[voxel]; }

  /// A voxel outside the grid has the weight of the nearest voxel inside. A cut through an object therefore
  /// stays flat.
  double weight(const Voxel& v) const { return share(weights_[index(clamped(v))]); }
  CornerWeights block(const Voxel& b) const {
    CornerValues values;
    for (std::size_t row = 0; row < 4; ++row) {
      const Voxel v{b.i, b.j + static_cast<int>(row & 1), b.k + static_cast<int>(row >> 1)};
      const Voxel low = clamped(v), high = clamped({v.i + 1, v.j, v.k});
      const std::size_t first = index(low);
      values[2 * row] = share(weights_[first]);
      values[2 * row + 1] = share(weights_[first + static_cast<std::size_t>(high.i - low.i)]);
    }
    return {values};
  }

 private:
  static double share(std::uint16_t parts) { return parts * (1.0 / kMost); }
  std::size_t index(const Voxel& v) const {
    return static_cast<std::size_t>(v.k) * slice_ + static_cast<std::size_t>(v.j) * row_ +
           static_cast<std::size_t>(v.i);
  }
  Voxel clamped(const Voxel& v) const {
    return {std::clamp(v.i, 0, size_[0] - 1), std::clamp(v.j, 0, size_[1] - 1),
            std::clamp(v.k, 0, size_[2] - 1)};
  }

  std::array<int, 3> size_;
  std::size_t row_, slice_;  // voxels
  HugeArray<std::uint16_t> weights_;
};

}  // namespace podm
