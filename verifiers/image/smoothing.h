// Smooth interfaces of a segmented image: a strength for each voxel, with which its label counts among the
// eight voxels around a point (label_function.h). Between two voxels of different labels and strengths a and
// b the label changes a / (a + b) of the way from the first, and centres of voxels keep their labels.
//
// Let W be the width, h the cube root of a voxel's volume, U the voxels with another label among their 26
// neighbours, background beyond the grid. A voxel of U has the depth
//   d_s = s sqrt(2 pi) / 3 * lead_s
// below the smoothed interface, mm: lead_s is by how much its own label leads once labels are blurred by s
// (label_blur.h). s is W at first. A voxel with d_s < -h/4 is lost: a structure thinner than s lies there.
// Voxels within ceil(2 s / spacing) of a lost one, along each axis, are tried again with half the width, and
// so on, until none is lost or s < h/2 (1 - 1e-5), where all that are left have the depth h/2: the stairs of
// voxels. No depth is less than h/20.
//   The strength is the depth over the greatest that is told apart, 1.1 W or h/2 if that is more, rounded to
// 65535ths. Where that lets a label grow or shrink it is taken back. The faces of a voxel of U are those to
// neighbours of other labels in the grid; a face across an axis counts round(256 * the shortest spacing / the
// axis's), and at least 1. Over all faces of voxels of the same label within ceil(2 W / spacing) of a voxel
// of U, along each axis, the mean of half the lead in strength, that of the voxel less that of the neighbour,
// is subtracted from its strength, and the difference rounded; the least is that of depth h/20, the greatest
// 65535. That is done twice. Voxels outside U have strength 1, which counts nowhere; those beyond the grid
// have the strength of the nearest inside. What is rounded up, ceil, is less by 1e-5 before.
#pragma once

#include "image/image.h"

namespace podm::verify {

/// Does not depend on the number of threads. Takes 4 bytes a voxel while it computes, 2 of which stay, and
/// some MB a thread. Throws InputError, which names the image's file, unless the width is above 0, at most 8
/// times the image's shortest spacing, and less than its shortest side.
Smoothing smooth(const Image& image, double width_mm, int threads);

}  // namespace podm::verify
