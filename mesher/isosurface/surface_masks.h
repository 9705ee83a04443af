// Which voxels are surface voxels: those with a 6-neighbour of another label, outside the grid counting as
// background.
#pragma once

#include <cstdint>

#include "image/voxel.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

/// By brick, a bit for each place in it. Voxels beyond the grid are none.
using SurfaceMasks = HugeArray<std::uint64_t>;

/// `masks`, all zero, has room for every brick. Runs on `threads` threads.
void mark_surface(const LabelImage& image, const BrickGrid& bricks, std::size_t threads, SurfaceMasks& masks);

}  // namespace podm
