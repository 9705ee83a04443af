// The sizes that an image gives to what options leave open: delta, and a radius for each label. The public
// default_delta_mm() is defined beside them.
#pragma once

#include "podm/mesh_image.h"
#include "sizing/size_census.h"
#include "sizing/size_field.h"

namespace podm {

/// The radius that the options give a label, mm; 0: unbounded.
double radius_mm_of(const SizeOptions& sizes, const Label& label);
/// The same of all labels, by index, the background unbounded; infinity: unbounded.
std::vector<double> radii_of_labels_mm(const LabelImage& image, const SizeOptions& sizes);

/// The least radius of all labels, mm; 0: unbounded.
double smallest_radius_mm(const SizeOptions& sizes);

/// The sampling distance that the options give, else the default of this image and the least radius, mm.
/// Surfaces follow small cells wherever these are asked for, so that sizes by place count by the largest that
/// a place has, if all have one. `census`: of these sizes by place; null: there are none.
double delta_mm_for(const LabelImage& image, const SizeOptions& sizes, const SizeCensus* census);

/// What the options ask for, label by label and, of the grid that make_size_grid() makes of them, by place.
SizeField size_field(const LabelImage& image, const SizeOptions& sizes,
                     std::shared_ptr<const SizeGrid> grid = nullptr);

}  // namespace podm
