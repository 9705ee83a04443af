// How far voxels are from the interface of some labels and others: the faces between their voxels.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// A part of an image's grid, which may reach one voxel beyond the image, and a distance for each voxel of
/// it.
struct InterfaceDistances {
  std::array<int, 3> first{};  ///< the part's first voxel
  std::array<int, 3> size{};   ///< voxels along the axes
  std::vector<float>
      distance_mm;  ///< from a voxel's centre to the nearest face, x fastest; infinity: beyond reach
};

/// Exact but for rounding to single precision, in the image's own axes; outside the image all is background.
/// The part holds all voxels that are within `reach_mm` of the interface. `side_of_label`: 1 or 2 for the
/// labels on either side, 0 for others. Nothing: the two sides do not touch. `threads`: 0 for all cores.
std::optional<InterfaceDistances> interface_distances(const LabelImage& image,
                                                      const std::vector<unsigned char>& side_of_label,
                                                      double reach_mm, int threads);

}  // namespace podm
