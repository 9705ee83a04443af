// The lead of each voxel's own label over all other labels once labels are blurred.
//
// G_s is the Gaussian of width s. Along an axis of spacing h its taps are exp(-(i h)^2 / (2 s^2)) for |i| <=
// ceil(3 s / h), scaled to sum to 1. In space it is the product of the three. The weight of a label is twice
// its indicator blurred by G_s minus its indicator blurred by G_2s, which leaves curved surfaces in place.
// Beyond the grid the image continues as at its border.
#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "image/voxel_box.h"

namespace podm::verify {

/// One per thread: it keeps the memory of the last box. It keeps a reference to the image.
class LabelBlur {
 public:
  LabelBlur(const Image& image, double width_mm);

  /// Returns for each voxel of the box, x fastest, the weight of its own label minus the greatest weight of
  /// another label, or minus 0 if no other weight is positive. The box must lie in the grid. Valid until the
  /// next call.
  ///
  /// Time: for each label within reach of the box, its taps times the voxels in and around the box. Memory: 4
  /// bytes per voxel in and around the box, and 40 per voxel of the box.
  const std::vector<double>& leads(const VoxelBox& box);

 private:
  struct Taps {
    std::array<std::vector<double>, 3> along;  // 2 reach + 1 taps
    std::array<int, 3> reach{};
  };
  static Taps gaussian(const Image& image, double width_mm);
  void add_blurred(std::uint32_t label, const VoxelBox& extent, const Taps& taps, double factor);
  void blur_rows(std::uint32_t label, const VoxelBox& source, const Taps& taps);
  void take_weights(std::uint32_t label);

  const Image& image_;
  Taps narrow_, wide_;
  VoxelBox around_, target_;  // the box that is copied; the box in which a label's weight is computed
  std::vector<std::uint32_t> labels_;  // in around_
  std::vector<double> line_, rows_, planes_, weights_;
  VoxelBox box_;
  std::vector<double> own_, others_;  // in box_
};

}  // namespace podm::verify
