// The features of a brick's voxels among the surface voxels of the bricks around, and what is around its own.
// One pass an axis, all in a window of voxels that stays in the first cache.
#pragma once

#include <array>
#include <cstdint>

#include "image/voxel.h"
#include "isosurface/neighborhood.h"
#include "isosurface/surface_masks.h"
#include "podm/label_image.h"

namespace podm {

/// Where the nearest surface voxel lies, from a voxel of a brick.
class FeatureOffset {
 public:
  constexpr FeatureOffset() = default;
  constexpr FeatureOffset(int i, int j, int k)
      : bits_(static_cast<std::uint16_t>((i + kZero) | (j + kZero) << 5 | (k + kZero) << 10)) {}
  constexpr explicit FeatureOffset(std::uint16_t bits) : bits_(bits) {}

  /// No surface voxel of the bricks around is certain to be the nearest.
  constexpr bool is_beyond() const { return bits_ == 0; }
  constexpr Voxel offset() const { return {along<0>(+bits_), along<1>(+bits_), along<2>(+bits_)}; }
  /// Of one offset, or of many in a register.
  template <int axis, class Bits>
  static constexpr Bits along(const Bits& bits) {
    return (bits >> (5 * axis) & 31) - kZero;
  }
  constexpr std::uint16_t bits() const { return bits_; }

 private:
  static constexpr int kZero = 16;
  std::uint16_t bits_ = 0;  // five an axis; the uppermost is free
};

/// How many bricks on each side of one, along each axis, are looked at for features: two of short voxels, so
/// that the features of at least eight of the shortest sides are told, one of those that are longer by 1.6.
class Surroundings {
 public:
  static constexpr int kMostBricks = 2;

  explicit Surroundings(const LabelImage& image);
  const std::array<int, 3>& num_bricks() const { return num_bricks_; }
  /// Surface voxels elsewhere are not nearer to any voxel of the brick, by centres.
  double reach_mm() const { return reach_mm_; }

 private:
  std::array<int, 3> num_bricks_;
  double reach_mm_;
};

/// Of the voxels of one brick after the other.
class BrickFeatures {
 public:
  /// Keeps references.
  BrickFeatures(const LabelImage& image, const BrickGrid& bricks, const SurfaceMasks& masks,
                const Surroundings& surroundings);

  /// By place; only features nearer than Surroundings::reach_mm() are told.
  std::array<FeatureOffset, 64> offsets(const Voxel& brick) const;

 private:
  struct Window;

  const BrickGrid& bricks_;
  const SurfaceMasks& masks_;
  const Surroundings& surroundings_;
  std::array<std::array<double, 24>, 3> squared_;  // mm, by axis and offset + kMostOffset
};

/// What is around the surface voxels of a brick: reads the 6^3 labels in and around it once.
class BrickNeighborhoods {
 public:
  BrickNeighborhoods(const LabelImage& image, const Voxel& brick);
  /// `place`: of a surface voxel in the brick.
  Neighborhood around(unsigned place) const;
  LabelIndex label(unsigned place) const { return labels_[first_around(place) + 7 * kRow + 1]; }

 private:
  static constexpr std::size_t kRow = 8;  // so that four labels can be read from each place
  static std::size_t first_around(unsigned place) {
    return (6 * (place >> 4) + (place >> 2 & 3)) * kRow + (place & 3);
  }
  std::array<LabelIndex, 36 * kRow> labels_;
};

}  // namespace podm
