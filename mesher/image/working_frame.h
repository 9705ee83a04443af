// The frame in which all geometry is computed.
//
// It is the world frame, RAS. Properties of the mesher's coordinates therefore hold for the coordinates in
// the file: any other conversion on output would invert the flattest slivers by rounding. A sheared image,
// for example from a tilted gantry, is the exception. No bound on angles survives shear, and distances are to
// be measured along the image's axes. Its frame is therefore the image's own, with the center of voxel
// (i,j,k) at (i,j,k) times the spacing.
#pragma once

#include "geometry/affine.h"
#include "podm/label_image.h"

namespace podm {

/// The map from voxel indices to the working frame, mm.
Affine voxels_to_working(const LabelImage& image);
/// The identity, which does not round, unless the image is sheared.
Affine working_to_world(const LabelImage& image);

}  // namespace podm
