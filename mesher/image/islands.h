// Islands: components of a label, not of the background, that are smaller than somebody wants to mesh.
#pragma once

#include <string>

#include "podm/label_image.h"

namespace podm {

/// Gives islands below so many mm^3 to their neighbours, in rounds: each to the label that it has the largest
/// area of faces in common with among the components that are no islands, the background's and what is
/// outside the grid included; of equal ones to the background, then to that of the least value. Islands
/// within islands wait for the next round. At the end no component of a label is smaller, so that to drop
/// again changes nothing. Labels that lose all go, and a warning tells. Notes what was dropped in the image.
/// Throws InputError naming `path` where the volume is not a positive number or all labels would go.
void drop_islands(LabelImage& image, double below_mm3, const std::string& path);

}  // namespace podm
