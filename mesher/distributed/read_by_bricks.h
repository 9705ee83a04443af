// Images that no rank holds as a whole. The voxels stay in the file. Each rank reads a slab of it twice:
// first its values, then its labels. All ranks learn of each brick of 4^3 voxels its label, or that it has
// surface voxels: 2 bytes for 64 voxels. From this each rank makes the table of the feature transform, 8
// bytes per brick, with exact bounds of distances for all of the image (feature_transform.h). It reads the
// voxels of bricks near the isosurface when a query first needs them (unread_bricks.h). It then holds those
// of its share of the predicted work (predicted_work.h), of its block, of the cover around it, and of the
// zones that it gets later.
//
// The file must stay unchanged. A reader compares its size and time with those at the beginning, and the
// bricks of a page with the labels of bricks that were found first.
//
// A compressed file cannot be read in parts. Rank 0 inflates it twice, a few slices at a time, and sends all
// ranks the labels of the bricks with surface voxels. Those of all other voxels are the labels of their
// bricks.
//
// No margin of a crop has to be proved. Each answer of the oracle depends on the table and on words of
// bricks, and both are the same as those of the whole image.
#pragma once

#include <memory>

#include "distributed/shared_value.h"
#include "image/voxel_file.h"
#include "podm/meshing_options.h"

namespace podm {

/// Returns true if runs with these options ask only for what an image by bricks has. Smoothed interfaces,
/// sizes near interfaces, graded sizes, size images and a target number of elements need all voxels; logs
/// have the hash of all.
bool can_stay_in_file(const LabelSelection& selection, const MeshingOptions& options);

/// Collective. Returns the image that a file has with this selection. The ranks of a process share it.
/// `threads`: 0 for all cores. Throws RefusedByAll if the ranks have different files, if reading takes more
/// than `most_bytes`, or if the file or the selection is refused as by read_image().
std::shared_ptr<const LabelImage> read_by_bricks(const std::shared_ptr<const VoxelFile>& file,
                                                 const LabelSelection& selection, int threads,
                                                 std::uint64_t most_bytes, SharedValue<LabelImage>& shared,
                                                 Communication& ranks);

}  // namespace podm
