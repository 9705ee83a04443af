// Checks the input of public functions.
#pragma once

#include "podm/mesh_image.h"

namespace podm {

/// Throws InputError unless the image holds voxels and has labels besides the background.
void check_voxels(const LabelImage& image);
/// Throws InputError, which names the fault, on options that contradict each other or the image, and on an
/// image without foreground or with an affine that does not match its voxels.
void check_options(const LabelImage& image, const MeshingOptions& options);
/// The same, without a look at the voxels: they may stay in the image's file.
void check_options_but_voxels(const LabelImage& image, const MeshingOptions& options);

}  // namespace podm
