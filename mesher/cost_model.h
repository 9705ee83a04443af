// What a mesh will cost, from the image alone: cells fill the volume as r_t^-3 and cover the interfaces as
// delta^-2.
#pragma once

#include "delaunay/mesh.h"
#include "podm/mesh_image.h"

namespace podm {

/// Bounds of the labelled voxels, mm, half a voxel wider than their centres... one voxel to be safe.
Box foreground_bounds(const LabelImage& image);

/// The uniform radius at which estimate() gives this many cells, mm.
double radius_for_cells(const LabelImage& image, const MeshingOptions& options, double cells);

}  // namespace podm
