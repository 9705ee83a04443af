// The frame that all geometry is computed in.
//
// It is the world, RAS, so that what holds of the mesher's coordinates holds of the file's: on another way
// out rounding turns the flattest of slivers inside out. A sheared image, as of a tilted gantry, is the
// exception. No bound on angles survives shear, and distances are to be measured along its axes: there the
// frame is the image's own, with the centre of voxel (i,j,k) at (i,j,k) times the spacing.
#pragma once

#include "geometry/affine.h"
#include "podm/label_image.h"

namespace podm {

/// The map from voxel indices to the working frame, mm.
Affine voxels_to_working(const LabelImage& image);
/// The identity, which rounds nothing, unless the image is sheared.
Affine working_to_world(const LabelImage& image);

}  // namespace podm
