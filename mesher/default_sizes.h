// The sizes that an image gives to what options leave open: delta, and a radius for each label. The public
// default_delta_mm() is defined beside them.
#pragma once

#include "podm/mesh_image.h"
#include "refine/size_field.h"

namespace podm {

/// The least radius of all labels, mm; 0: unbounded.
double smallest_radius_mm(const SizeOptions& sizes);

/// The sampling distance that the options give, else the default of this image and the least radius, mm.
double delta_mm_for(const LabelImage& image, const SizeOptions& sizes);

/// The radius of each label, where the options bound it.
SizeField size_field(const LabelImage& image, const SizeOptions& sizes);

}  // namespace podm
