// The voxels of a label image that have a label: their number and their bounds. `threads`: 0 for all cores.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "podm/label_image.h"

namespace podm {

/// The number of voxels by label, including the background.
std::vector<std::uint64_t> count_voxels(const LabelImage& image, int threads);

/// Bounds of the foreground in the working frame, mm: the centers of the labelled voxels, and one voxel more
/// on every side. Throws InputError if there is no foreground.
Box foreground_bounds(const LabelImage& image, int threads = 1);

}  // namespace podm
