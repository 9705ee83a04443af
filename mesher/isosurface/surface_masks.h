// Marks the surface voxels: those with a 6-neighbor of another label. Outside the grid everything counts as
// background, unless the box is flat: no voxel outside then has another label.
#pragma once

#include <cstdint>

#include "image/voxel.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

/// One word per brick, with one bit for each place in it. Places beyond the grid are not marked.
using SurfaceMasks = HugeArray<std::uint64_t>;

/// `masks` must be all zero, with room for every brick. Runs on `threads` threads.
void mark_surface(const LabelImage& image, const BrickGrid& bricks, std::size_t threads, SurfaceMasks& masks);

}  // namespace podm
