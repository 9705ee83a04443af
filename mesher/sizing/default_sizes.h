// The sizes that an image implies where options leave them open: delta, and a radius for each label. The
// public default_delta_mm() is defined in the same source file.
#pragma once

#include "podm/mesh_image.h"
#include "sizing/size_census.h"
#include "sizing/size_field.h"

namespace podm {

/// The radius that the options give a label, mm; 0 if unbounded.
double radius_mm_of(const SizeOptions& sizes, const Label& label);
/// The radii of all labels, mm, by index; infinity if unbounded. The background is unbounded.
std::vector<double> radii_of_labels_mm(const LabelImage& image, const SizeOptions& sizes);

/// The least radius of all labels, mm; 0 if all are unbounded.
double smallest_radius_mm(const SizeOptions& sizes);

/// The sampling distance, mm: that of the options if set, otherwise the default for this image and the least
/// radius. Small cells refine surfaces near them anyway. Local sizes therefore count only by the largest
/// bound of any place, if every place has one. `census` describes these local sizes; null if there are none.
double delta_mm_for(const LabelImage& image, const SizeOptions& sizes, const SizeCensus* census);

/// The size field that the options request: a radius per label, and local sizes from the grid that
/// make_size_grid() makes of the options.
SizeField size_field(const LabelImage& image, const SizeOptions& sizes,
                     std::shared_ptr<const SizeGrid> grid = nullptr);

}  // namespace podm
