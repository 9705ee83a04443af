// What mesh_image() refuses.
#pragma once

#include "podm/mesh_image.h"

namespace podm {

/// Throws InputError, naming the fault, on options that contradict themselves or the image, and on an image
/// that has no foreground or whose affine is not that of its voxels.
void check_options(const LabelImage& image, const MeshingOptions& options);

}  // namespace podm
