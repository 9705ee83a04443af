// An image whose voxels stay in its file: what is known of each brick of 4^3 voxels, and a reader of the
// voxels of any box.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "image/voxel.h"
#include "podm/label_image.h"

namespace podm {

inline constexpr std::size_t kMaxBricks = 0x7fffffff;  ///< of an image whose voxels stay in its file

/// Its `voxels` are empty. Every other image that is meshed holds all its voxels. Must not be copied as a
/// LabelImage.
struct ImageByBricks : LabelImage {
  /// Stands for the label of a brick that has surface voxels: voxels with a 6-neighbor of another label.
  /// Outside the image everything is background.
  static constexpr LabelIndex kMixed = 0xffff;

  std::string path;                        ///< of the file
  std::vector<LabelIndex> label_of_brick;  ///< by position in BrickGrid
  std::vector<std::uint64_t> voxels_of_label;
  std::array<int, 3> low{}, high{};  ///< the first and the last foreground voxel along each axis
  /// The sides of interfaces between neighbors along each axis that have a label. Outside is background.
  std::array<std::uint64_t, 3> sides{};
  std::string digest;  ///< of all labels of voxels
  /// Returns the part of the image from `low` to `high`, which is excluded, with all labels of the image. Any
  /// thread may call it. Throws InputError if the file cannot be read.
  std::function<LabelImage(const Voxel& low, const Voxel& high)> read;
};

/// Null if the image holds its voxels. Public functions refuse every other image that has none, as this
/// function cannot.
inline const ImageByBricks* by_bricks(const LabelImage& image) {
  return image.voxels.empty() ? static_cast<const ImageByBricks*>(&image) : nullptr;
}

}  // namespace podm
