// The voxels of a label image that have a label: how many, and where. `threads`: 0 for all cores.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "podm/label_image.h"

namespace podm {

/// Voxels by label, the background too.
std::vector<std::uint64_t> count_voxels(const LabelImage& image, int threads);

/// Bounds of the foreground in the working frame, mm: centres of the labelled voxels and one voxel more on
/// every side. Throws InputError when there is no foreground.
Box foreground_bounds(const LabelImage& image, int threads = 1);

}  // namespace podm
