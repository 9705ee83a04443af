// Merges the layers of a segmentation, whose segments may overlap, into an image of one label per voxel.
#pragma once

#include <cstddef>
#include <string>

#include "image/raw_image.h"
#include "podm/image_io.h"

namespace podm {

/// Throws InputError naming `path` if the selection orders layers that the file lacks, or if it orders layers
/// and the image has no segments.
void check_layers(const std::string& path, const LabelSelection& selection, std::size_t num_segments,
                  std::size_t num_layers);

/// Replaces the layers of an image that has several by the labels of its segments, of which the topmost is
/// taken at each voxel; 0 where there is none. From bottom to top:
/// 1. segments that the selection drops or does not keep;
/// 2. the other segments, in the order of the layers given by the selection, otherwise in the file's order.
///
/// Counts the voxels of segments. `warnings` gets a sentence for each kept segment that others cover in part,
/// and one if labels have other values than the file. Throws InputError naming the file and the voxel if a
/// voxel's value is that of no segment in its layer.
void merge_layers(RawImage& raw, const LabelSelection& selection, std::size_t threads);

}  // namespace podm
