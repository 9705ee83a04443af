// The numbers that a file or an array stores become label indices.
#pragma once

#include <cstddef>
#include <string>

#include "image/raw_image.h"
#include "podm/label_image.h"

namespace podm {

/// Fills `labels`, every value that occurs, ascending, and `voxels`, as many as the image's size says. Throws
/// InputError naming `path`: a number that is no label, too many different ones.
void index_voxels(const VoxelArray& array, const std::string& path, std::size_t threads, LabelImage& image);

}  // namespace podm
