// What is kept of an image's labels, and their final order.
#pragma once

#include <string>

#include "podm/image_io.h"

namespace podm {

/// Takes an image whose voxels index `labels` in any order; leaves the background first, then the labels that
/// have voxels and that the selection keeps, by value. Keeping and dropping come before merging,
/// islands go last. Throws InputError naming `path`: a value asked for by itself that is absent, a
/// contradictory merge, a bad volume of islands, nothing left.
void select_labels(LabelImage& image, const LabelSelection& selection, const std::string& path,
                   std::size_t threads);

}  // namespace podm
