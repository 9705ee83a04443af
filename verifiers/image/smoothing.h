// Smooths the interfaces of a segmented image. Each voxel gets a weight, by which its label counts among
// the eight voxels around a point (label_function.h). Between two voxels of different labels and weights a
// and b the label changes a / (a + b) of the way from the first. Centers of voxels keep their labels.
//
// Let W be the width, h the cube root of a voxel's volume, and U the voxels with another label among their 26
// neighbours, where background lies beyond the grid. A voxel of U has the depth
//   d_s = s sqrt(2 pi) / 3 * lead_s
// below the smoothed interface, mm. Here lead_s is the lead of its own label once labels are blurred by s
// (label_blur.h). At first s is W. A voxel with d_s < -h/4 is lost: a structure thinner than s lies there.
// Voxels within ceil(2 s / spacing) of a lost voxel, along each axis, are tried again with half the width.
// This repeats until no voxel is lost, or until s < h/2 (1 - 1e-5); then all voxels that are left have the
// depth h/2: the stairs of voxels. No depth is less than h/20.
//
// The weight is the depth divided by the greatest depth that is distinguished, 1.1 W or h/2 if that is
// more, rounded to 65535ths. Where such weights let a label grow or shrink, this change is undone. The faces
// of a voxel of U are its faces to neighbours of other labels in the grid. A face across an axis counts
// round(256 * the shortest spacing / the axis's spacing), and at least 1. The lead of a face is the weight
// of its voxel minus the weight of the neighbour. The mean of half the lead over all faces of voxels of the
// same label within ceil(2 W / spacing) of a voxel of U, along each axis, is subtracted from the weight of
// that voxel, and the difference is rounded. The least result is the weight of depth h/20, the greatest is
// 65535. This step is done twice. Voxels outside U have weight 1, which counts nowhere. Voxels beyond the
// grid have the weight of the nearest voxel inside. Every number that is rounded up, ceil, is first reduced
// by 1e-5.
#pragma once

#include "image/image.h"

namespace podm::verify {

/// The result does not depend on the number of threads. The computation takes 4 bytes per voxel, 2 of which
/// stay, and a few MB per thread. Throws InputError, which names the image's file, unless the width is above
/// 0, at most 8 times the image's shortest spacing, and less than its shortest side.
Smoothing smooth(const Image& image, double width_mm, int threads);

}  // namespace podm::verify
