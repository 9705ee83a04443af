// From what was asked on the command line to what the library is told, given the image and the machine.
#pragma once

#include "cli/options.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"

namespace podm::cli {

/// Throws InputError, naming the image and the fault, where a label is absent, delta exceeds the image, or
/// the run is expected to need more memory than allowed.
MeshingOptions meshing_options(const MeshCommand& command, const LabelImage& image);

}  // namespace podm::cli
