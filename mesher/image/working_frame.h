// The frame in which all geometry is computed.
//
// It is the world frame, RAS. Properties of the mesher's coordinates therefore hold for the coordinates in
// the file: any other conversion on output would invert the flattest slivers by rounding. A sheared image,
// for example from a tilted gantry, is the exception. No bound on angles survives shear, and distances are to
// be measured along the image's axes. Its frame is therefore the image's own, with the center of voxel
// (i,j,k) at (i,j,k) times the spacing. So it is if the box is flat (LabelImage::is_box_flat), unless each
// axis of the image is parallel to one of the world: doubles do not lie on oblique planes, and points beside
// a plane would make flat cells along it.
#pragma once

#include "geometry/affine.h"
#include "podm/label_image.h"

namespace podm {

/// True if the affine shears by more than rounding explains.
bool is_sheared(const LabelImage& image);
/// The map from voxel indices to the working frame, mm.
Affine voxels_to_working(const LabelImage& image);
/// The identity, which does not round, unless the frame is the image's own.
Affine working_to_world(const LabelImage& image);

}  // namespace podm
