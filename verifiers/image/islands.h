// Islands of an image that were not meshed, found and relabelled by the verifier's own code.
#pragma once

#include "image/image.h"

namespace podm::verify {

/// Relabels islands. An island is a face-connected set of voxels of one label, not `background`, that fills
/// less than `below_mm3`. An island that touches voxels outside all islands takes the label with which it
/// shares the largest area of faces with them; outside the grid counts as background. Among equal areas the
/// background comes first, then the least label. This repeats until no island is left. Throws InputError if
/// all voxels are then background.
void drop_islands(Image& image, std::uint32_t background, double below_mm3);

}  // namespace podm::verify
