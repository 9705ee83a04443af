// Exact Euclidean feature transform: for every voxel the nearest surface voxel, by centres, in mm.
//
// A *surface voxel* has a 6-neighbour of another label; outside the grid counts as background. One pass an
// axis: the nearest surface voxel within the x-line, then within the slice, then within the grid, each pass
// from the lower envelope of the parabolas that the previous pass left along its lines (Maurer, Qi, Raghavan,
// PAMI 25 (2003) 265-270; Felzenszwalb, Huttenlocher, Theory of Computing 8 (2012) 415-428).
#pragma once

#include <cstddef>
#include <cstdint>

#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

class FeatureTransform {
 public:
  /// Position of a voxel in LabelImage::voxels.
  using VoxelIndex = std::uint32_t;
  /// What an image of one label has everywhere.
  static constexpr VoxelIndex kNone = ~VoxelIndex{0};

  /// Runs on `threads` threads (0: all cores); the result is the same for any number.
  /// Throws InputError if the image has more than 2^32 - 1 voxels.
  FeatureTransform(const LabelImage& image, int threads);

  /// The surface voxel whose centre is nearest to the centre of `voxel`.
  VoxelIndex nearest(std::size_t voxel) const { return features_[voxel]; }

 private:
  HugeArray<VoxelIndex> features_;
};

}  // namespace podm
