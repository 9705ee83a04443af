// Finds the features of a brick's voxels among the surface voxels of the surrounding bricks, and the
// neighborhoods of the brick's own surface voxels. It makes one pass per axis, in a window of voxels that
// stays in the L1 cache.
#pragma once

#include <array>
#include <cstdint>

#include "image/voxel.h"
#include "isosurface/neighborhood.h"
#include "isosurface/surface_masks.h"
#include "podm/label_image.h"

namespace podm {

/// The offset from a voxel of a brick to its nearest surface voxel.
class FeatureOffset {
 public:
  constexpr FeatureOffset() = default;
  constexpr FeatureOffset(int i, int j, int k)
      : bits_(static_cast<std::uint16_t>((i + kZero) | (j + kZero) << 5 | (k + kZero) << 10)) {}
  constexpr explicit FeatureOffset(std::uint16_t bits) : bits_(bits) {}

  /// True if no surface voxel of the surrounding bricks is certain to be the nearest.
  constexpr bool is_beyond() const { return bits_ == 0; }
  constexpr Voxel offset() const { return {along<0>(+bits_), along<1>(+bits_), along<2>(+bits_)}; }
  /// Decodes one offset, or several in a register.
  template <int axis, class Bits>
  static constexpr Bits along(const Bits& bits) {
    return (bits >> (5 * axis) & 31) - kZero;
  }
  constexpr std::uint16_t bits() const { return bits_; }

 private:
  static constexpr int kZero = 16;
  std::uint16_t bits_ = 0;  // five bits per axis; the top bit is free
};

/// The number of bricks on each side of a brick, along each axis, that are searched for features. It is two
/// along an axis where the voxels are short, and one where they are at least 1.6 times as long as the
/// shortest side. All features within eight shortest sides are therefore found.
class Surroundings {
 public:
  static constexpr int kMostBricks = 2;

  explicit Surroundings(const LabelImage& image);
  const std::array<int, 3>& num_bricks() const { return num_bricks_; }
  /// Surface voxels outside the searched bricks are at least this far, by centers, from every voxel of the
  /// brick.
  double reach_mm() const { return reach_mm_; }

 private:
  std::array<int, 3> num_bricks_;
  double reach_mm_;
};

/// Finds the features of the voxels of one brick after another.
class BrickFeatures {
 public:
  /// Keeps references to `bricks`, `masks` and `surroundings`.
  BrickFeatures(const LabelImage& image, const BrickGrid& bricks, const SurfaceMasks& masks,
                const Surroundings& surroundings);

  /// The offsets by place in the brick. Only features nearer than Surroundings::reach_mm() are returned.
  std::array<FeatureOffset, 64> offsets(const Voxel& brick) const;

 private:
  struct Window;

  const BrickGrid& bricks_;
  const SurfaceMasks& masks_;
  const Surroundings& surroundings_;
  std::array<double, 3> spacing_;
  std::array<double, 24> squared_y_, squared_z_;  // mm^2, by offset + kMostOffset
};

/// The neighborhoods of the surface voxels of a brick. It reads the 6^3 labels in and around the brick once.
class BrickNeighborhoods {
 public:
  BrickNeighborhoods(const LabelImage& image, const Voxel& brick);
  /// `place` must be that of a surface voxel in the brick.
  Neighborhood around(unsigned place) const;
  LabelIndex label(unsigned place) const { return labels_[first_around(place) + 7 * kRow + 1]; }

 private:
  // As the constructor, with the labels at the border instead of background outside.
  void read_clamped(const LabelImage& image, const Voxel& first);
  static constexpr std::size_t kRow = 8;  // leaves room to read four labels from each place
  static std::size_t first_around(unsigned place) {
    return (6 * (place >> 4) + (place >> 2 & 3)) * kRow + (place & 3);
  }
  std::array<LabelIndex, 36 * kRow> labels_;
};

}  // namespace podm
