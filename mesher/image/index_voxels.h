// The numbers that a file stores become label indices.
#pragma once

#include "image/raw_image.h"
#include "podm/label_image.h"

namespace podm {

/// Fills `labels`, every value that occurs, ascending, and `voxels`. Throws InputError naming the image: a
/// number that is no label, too many different ones.
void index_voxels(const RawImage& raw, std::size_t threads, LabelImage& image);

}  // namespace podm
