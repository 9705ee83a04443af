// By how much each voxel's own label leads over all others once labels are blurred.
//
// G_s is the Gaussian of width s: along an axis of spacing h its taps are exp(-(i h)^2 / (2 s^2)) for
// |i| <= ceil(3 s / h), scaled to sum to 1; in space it is the product of the three. The weight of a label is
// twice its indicator blurred by G_s less that blurred by G_2s, which leaves curved surfaces in their place.
// Beyond the grid the image goes on as at its border.
#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "image/voxel_box.h"

namespace podm::verify {

/// For one thread: keeps the memory of the last box. Keeps a reference to the image.
class LabelBlur {
 public:
  LabelBlur(const Image& image, double width_mm);

  /// For each voxel of the box, x fastest, the weight of its own label less the greatest of the others, or
  /// less 0 if none is above that. The box lies in the grid. Valid until the next call.
  ///
  /// Costs for each label within reach of the box its taps times the voxels in and around the box; 4 bytes a
  /// voxel in and around it, and 40 a voxel of it.
  const std::vector<double>& leads(const VoxelBox& box);

 private:
  struct Taps {
    std::array<std::vector<double>, 3> along;  // 2 reach + 1 of them
    std::array<int, 3> reach{};
  };
  static Taps gaussian(const Image& image, double width_mm);
  void add_blurred(std::uint32_t label, const VoxelBox& extent, const Taps& taps, double factor);
  void blur_rows(std::uint32_t label, const VoxelBox& source, const Taps& taps);
  void take_weights(std::uint32_t label);

  const Image& image_;
  Taps narrow_, wide_;
  VoxelBox around_, target_;           // what is copied; where a label's weight is computed
  std::vector<std::uint32_t> labels_;  // in around_
  std::vector<double> line_, rows_, planes_, weights_;
  VoxelBox box_;
  std::vector<double> own_, others_;  // in box_
};

}  // namespace podm::verify
