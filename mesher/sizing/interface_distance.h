// Distances of voxels from the interface between two sets of labels, which consists of the faces between
// their voxels.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// A part of an image's grid, with a distance for each of its voxels. The part may extend one voxel beyond
/// the image.
struct InterfaceDistances {
  std::array<int, 3> first{};  ///< first voxel of the part
  std::array<int, 3> size{};   ///< voxels along the axes
  std::vector<float>
      distance_mm;  ///< from a voxel's center to the nearest face, x fastest; infinity if beyond reach
};

/// Exact except for rounding to single precision, in the image's own axes. Outside the image everything is
/// background. The part contains all voxels within `reach_mm` of the interface. `side_of_label` is 1 or 2 for
/// the labels on either side, 0 for other labels. Returns nothing if the two sides do not touch. `threads`: 0
/// for all cores.
std::optional<InterfaceDistances> interface_distances(const LabelImage& image,
                                                      const std::vector<unsigned char>& side_of_label,
                                                      double reach_mm, int threads);

}  // namespace podm
