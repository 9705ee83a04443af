// What a mesh will cost, from the image alone: cells fill the volume as r_t^-3 and cover the interfaces as
// delta^-2. `threads`: 0 for all cores.
#pragma once

#include "delaunay/mesh.h"
#include "podm/mesh_image.h"

namespace podm {

/// Bounds of the foreground, mm: centres of the labelled voxels and one voxel more on every side.
Box foreground_bounds(const LabelImage& image, int threads = 1);

/// The uniform radius, mm, at which this many cells are expected, with delta half of it.
double radius_for_cells(const LabelImage& image, double cells, int threads);

}  // namespace podm
