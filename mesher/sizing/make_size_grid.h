// Makes the grids of the local sizes that the options request. Cells are compared with these grids.
#pragma once

#include <cstdint>
#include <memory>

#include "podm/label_image.h"
#include "podm/meshing_options.h"
#include "sizing/size_grid.h"

namespace podm {

/// Null if the options request no local sizes. Throws InputError if the size image has no point, or no size,
/// in common with the object, if the sides of an interface do not touch, or if a label is on both sides of
/// it. `threads`: 0 for all cores.
///
/// Graded sizes are stored at every n-th voxel along each axis, with the smallest n that keeps at most
/// kMostGradedNodes nodes. They are interpolated between these nodes. The error of a graded bound, up or
/// down, is at most the slope times the diagonal of a cell of nodes.
std::shared_ptr<const SizeGrid> make_size_grid(const LabelImage& image, const SizeOptions& sizes,
                                               int threads);

inline constexpr std::size_t kMostGradedNodes = std::size_t{1} << 26;
/// The most memory that the grids take while they are made, in bytes, without the size image.
std::uint64_t bytes_of_size_grid(const LabelImage& image, const SizeOptions& sizes);

/// The size image alone, in the image's working frame.
ScalarGrid size_image_grid(const LabelImage& image, const std::shared_ptr<const SizeImage>& sizes);

}  // namespace podm
