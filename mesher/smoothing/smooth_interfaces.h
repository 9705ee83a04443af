// Smooths the interfaces, which are otherwise stairs of voxels: finds voxel weights (voxel_weights.h) that
// place the interfaces where blurred labels tie.
//
// The weight of a label, its indicator w, is blurred to 2 G_s w - G_2s w, where G_s is the Gaussian of width
// s. A surface of curvature c moves inward by s^2 c / 2 under G_s, and its slope there is 1/s. The value
// there therefore sinks by s c, to first order. Twice the narrow blur minus the wide one keeps the surface in
// place, and with it the volume. At a voxel of label l
//
//   d = s sqrt(2 pi) / 3 (w_l - the greatest weight of another label)
//
// is the distance to where l ties, by the slope of the blur of a plane. In thin structures d may be negative:
// l has lost its own voxel. A voxel is lost to a blur of this width if it lies more than a quarter of a voxel
// beyond its interface. Then all voxels within 2 s of it, along each axis, take half the width, and so on.
// Below half a voxel, stairs remain. (Distances scale with widths, therefore a plane passes on smoothly.)
// Every other voxel whose distance is below a twentieth of a voxel takes a twentieth of a voxel, the least
// distance.
//
// Last, volumes are corrected. Where a blur is as wide as a part is thick, the part's label has grown or
// shrunk. The shift of its interface is averaged over all faces of its voxels within twice the whole width
// along each axis (interface_shift.h). It is subtracted from the distances of the label's voxels, which stay
// within the least and the greatest distance that can be represented. This is done twice, as labels share
// interfaces. Slabs and rods of cubic voxels therefore keep their volume, and a sheet of one voxel stays one
// voxel thick. Rods as thin as voxels that are not cubes lose some volume. Stairs do not come back: s smooths
// no stairs that are longer than these averages.
//
// "A voxel" as a length is the side of a cube of its volume. Beyond the grid the image continues as at its
// border. The taps of a Gaussian reach three widths and are normalised. Lengths are compared with whole
// voxels and with half a voxel. In these comparisons a relative difference of kLengthRounding counts as
// equal.
#pragma once

#include <memory>
#include <vector>

#include "isosurface/voxel_weights.h"
#include "podm/label_image.h"

namespace podm {

inline constexpr double kMostWidth = 8;  // relative to the shortest side of a voxel

/// Throws InputError unless the width is positive, at most kMostWidth and below the image's shortest side.
void check_width(const LabelImage& image, double width_mm);
/// True if the width is below half a voxel, so that all stairs remain.
bool keeps_all_stairs(const LabelImage& image, double width_mm);

struct SmoothInterfaces {
  std::shared_ptr<const VoxelWeights> weights;
  /// Labels that a blur of the whole width would have lost, in ascending order. Narrower blurs keep them.
  std::vector<LabelIndex> labels_lost;
};

/// Smooths by a blur of this width, on `threads` threads (0: all cores). The result is the same for any
/// number of threads. Besides the weights it takes some bytes for each voxel beside another label, and some
/// MB per thread. Throws as check_width() does.
SmoothInterfaces smooth_interfaces(const LabelImage& image, double width_mm, int threads);

/// Only the weights; null for a width of 0, where nothing is smoothed.
std::shared_ptr<const VoxelWeights> weights_of(const LabelImage& image, double width_mm, int threads);

/// The volume of each label in an image with these voxel weights, mm^3, by index in LabelImage::labels. It is
/// sampled at 64 points per voxel.
std::vector<double> volumes_mm3(const LabelImage& image, const VoxelWeights& weights, int threads);

}  // namespace podm
