// The sides of the interfaces between voxels.
#pragma once

#include <cstdint>

#include "podm/label_image.h"

namespace podm {

/// Counts sides between voxels `lag` apart along the axis. Counts all pairs whose first voxel is in the row,
/// and those pairs whose second voxel is in the row and whose first is outside the image. Outside is
/// background.
std::uint64_t count_sides(const LabelImage& image, std::size_t axis, int lag, int j, int k);

}  // namespace podm
