// Islands: components of a label, except the background, that are smaller than the user wants to mesh.
#pragma once

#include <string>

#include "podm/label_image.h"

namespace podm {

/// Gives islands below `below_mm3` to their neighbors, in rounds. Each island goes to the label with which it
/// shares the largest area of faces. Only components that are not islands count, including the background and
/// everything outside the grid. A tie goes to the background, then to the label of the least value. Islands
/// within islands wait for the next round. At the end no component of a label is smaller than `below_mm3`,
/// therefore dropping again changes nothing. Labels that lose all voxels are removed, with a warning. The
/// image records the dropped islands. Throws InputError naming `path` if the volume is not a positive number
/// or all labels would be removed.
void drop_islands(LabelImage& image, double below_mm3, const std::string& path);

}  // namespace podm
