// The sides of a flat box that vertices of a mesh are on, by their coordinates in the file.
//
// A side is the plane of the outer faces of the outermost voxels: voxel index -1/2, or the number of voxels
// less 1/2, along one axis. If the axes of the image are parallel to those of the file, a plane is a
// coordinate, and doubles lie on it. The vertices on it must then have one coordinate, the exact one or a
// neighbour among the doubles. In other frames they must lie within 2 units in the last place of the box's
// largest coordinate.
#pragma once

#include <array>
#include <cstdint>

#include "claims/voxel_map.h"
#include "image/image_frame.h"

namespace podm::verify {

inline constexpr std::size_t kNumSides = 6;
inline constexpr std::array<const char*, kNumSides> kSideNames{"i-", "i+", "j-", "j+", "k-", "k+"};
/// A vertex of the surface that is this near to a plane of the box, in voxels, must be in it.
inline constexpr double kNearSideVoxels = 5e-4;

using SideSet = std::uint8_t;  ///< bit k: side k, in the order of kSideNames

class SidesOfVertices {
 public:
  SidesOfVertices(const Image& image, const ImageFrame& frame, Space space);

  /// The sides that a point of the file is near to.
  SideSet near(const Point& p) const;
  /// The distance of a point from the plane of a side, in units in the last place: 0 or more. In a parallel
  /// frame the doubles beside the exact coordinate count as on it.
  double ulps_off(const Point& p, std::size_t side, std::uint64_t& num_exact) const;
  double most_ulps() const { return is_parallel_ ? 0 : 2; }
  /// True if the image's axes are parallel to those of the file.
  bool is_parallel() const { return is_parallel_; }
  /// The coordinate of the file that a side of a parallel frame fixes.
  std::size_t row_of(std::size_t side) const { return row_of_axis_[axis_of(side)]; }
  /// The plane of a side, as voxel index along its axis.
  double plane(std::size_t side) const { return (side & 1) == 0 ? -0.5 : size_[side / 2] - 0.5; }
  static std::size_t axis_of(std::size_t side) { return side / 2; }

 private:
  std::array<int, 3> size_;
  std::array<double, 3> spacing_;
  const ImageFrame& frame_;
  VoxelMap to_voxels_;
  bool is_parallel_ = true;
  std::array<std::size_t, 3> row_of_axis_{};                   // of a parallel frame
  std::array<std::array<double, 2>, kNumSides> doubles_at_{};  // around the exact coordinate of each side
  double ulp_ = 0;                                             // of the largest coordinate of the box
};

}  // namespace podm::verify
