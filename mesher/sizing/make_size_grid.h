// The sizes that options ask for by place, as the grids that cells are compared with.
#pragma once

#include <cstdint>
#include <memory>

#include "podm/label_image.h"
#include "podm/meshing_options.h"
#include "sizing/size_grid.h"

namespace podm {

/// Null where the options ask for none. Throws InputError: the size image has no point in common with the
/// object, or the sides of an interface do not touch. `threads`: 0 for all cores.
///
/// What is graded is kept at the image's voxels, or at every second, third .. of them along each axis where
/// there are more than kMostGradedNodes, and interpolated between them. There a bound errs, upwards and down,
/// by no more than the slope times the diagonal of such a voxel.
std::shared_ptr<const SizeGrid> make_size_grid(const LabelImage& image, const SizeOptions& sizes,
                                               int threads);

inline constexpr std::size_t kMostGradedNodes = std::size_t{1} << 26;
/// The most that it takes while it is made, the size image apart.
std::uint64_t bytes_of_size_grid(const LabelImage& image, const SizeOptions& sizes);

/// The size image alone, in the image's working frame.
ScalarGrid size_image_grid(const LabelImage& image, const std::shared_ptr<const SizeImage>& sizes);

}  // namespace podm
