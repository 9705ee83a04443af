// Turns the numbers that a file or an array stores into label indices.
#pragma once

#include <cstddef>
#include <string>

#include "image/raw_image.h"
#include "image/voxel.h"
#include "podm/label_image.h"

namespace podm {

/// Fills `labels` with every value that occurs, in ascending order, and `voxels` according to the image's
/// size. Throws InputError naming `path` if a number is not a label, or if there are too many different
/// numbers. `first` is the place in the file of the array's first voxel, for messages.
void index_voxels(const VoxelArray& array, const std::string& path, std::size_t threads, LabelImage& image,
                  const Voxel& first = {});

}  // namespace podm
