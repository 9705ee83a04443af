// Interfaces without the stairs of voxels: the strengths (voxel_strengths.h) that lay them where blurred
// labels tie.
//
// The weight of a label, its indicator w, is blurred to 2 G_s w - G_2s w, with G_s the Gaussian of width s.
// A surface of curvature c moves inward by s^2 c / 2 under G_s, and its slope there is 1/s: it sinks by s c,
// to first order, so that twice the one less the other keeps it in place, and with it the volume. At a voxel
// of label l
//
//   d = s sqrt(2 pi) / 3 (w_l - the greatest of another label)
//
// is the distance to where l ties, by the slope of the blur of a plane. Where structures are thin it says
// that l has lost its own voxel. One that lies more than a quarter of a voxel beyond its interface is lost to
// a blur of that width: all voxels within 2 s of it, along each axis, take half the width, and so on; below
// half a voxel stairs remain. (Distances scale with widths, so that a plane passes on smoothly.) What is
// nearer to the interface, or not lost by more, takes the least distance, a twentieth of a voxel.
//
// Last, volumes are kept: where a blur is as wide as a part is thick, its label has grown or shrunk, and what
// its interface has moved, on average over all faces of its voxels within twice the whole width along each
// axis (interface_shift.h), is taken from the distances of its voxels, which stay within the least and the
// greatest that is told apart; and once more, as labels share interfaces.
// So slabs and rods of cubic voxels keep their volume, and a sheet of one voxel is one voxel thick; of rods
// as thin as voxels that are no cubes some is lost. Stairs do not come back: s smooths none that are longer
// than these averages.
//
// A voxel here is the side of a cube of its volume. Beyond the grid the image goes on as at its border. Taps
// of a Gaussian reach three widths and are normalised. In what is compared, here in whole voxels and there
// with half a voxel, widths that are alike but for kLengthRounding are alike.
#pragma once

#include <memory>
#include <vector>

#include "isosurface/voxel_strengths.h"
#include "podm/label_image.h"

namespace podm {

inline constexpr double kMostWidth = 8;  // of voxels' shortest sides

/// Throws InputError if the width is not positive, at most kMostWidth and below the image's shortest side.
void check_width(const LabelImage& image, double width_mm);
/// Whether it is below half a voxel, so that all stairs remain.
bool keeps_all_stairs(const LabelImage& image, double width_mm);

struct SmoothInterfaces {
  std::shared_ptr<const VoxelStrengths> strengths;
  /// Labels that a blur of the whole width would have lost, from smallest to largest; narrower ones keep
  /// them.
  std::vector<LabelIndex> labels_lost;
};

/// Smooths by a blur of that width, on `threads` threads (0: all cores); the result is the same for any
/// number. Beside the strengths it takes some bytes for each voxel beside another label, and some MB a
/// thread. Throws as check_width() does.
SmoothInterfaces smooth_interfaces(const LabelImage& image, double width_mm, int threads);

/// The strengths alone; null for a width of 0, where nothing is smoothed.
std::shared_ptr<const VoxelStrengths> strengths_of(const LabelImage& image, double width_mm, int threads);

/// The volume of each label in an image with such strengths, mm^3, by index in LabelImage::labels: of 64
/// points a voxel.
std::vector<double> volumes_mm3(const LabelImage& image, const VoxelStrengths& strengths, int threads);

}  // namespace podm
