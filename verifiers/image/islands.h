// Islands of an image that were not meshed, found and given away by the verifier's own code.
#pragma once

#include "image/image.h"

namespace podm::verify {

/// An island is a set of voxels of one label, not `background`, that are joined by faces, one after the
/// other, and fill less than `below_mm3`. Those that touch something else than islands, outside of the grid
/// counting as background, become what they share the largest area of faces with of it; of equal areas the
/// background goes first, then the least label. That is repeated until no island is left. Throws InputError
/// if then all is background.
void drop_islands(Image& image, std::uint32_t background, double below_mm3);

}  // namespace podm::verify
