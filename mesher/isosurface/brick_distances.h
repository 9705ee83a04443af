// How far bricks are from the marked ones: the exact Euclidean distance transform, one pass an axis, from the
// lower envelopes of the parabolas that the pass before left along the lines (Maurer, Qi, Raghavan, PAMI 25
// (2003) 265-270; Felzenszwalb, Huttenlocher, Theory of Computing 8 (2012) 415-428).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "image/voxel.h"

namespace podm {

/// `squared`: the bits of a double by brick, 0 where it is marked and infinity elsewhere, which becomes the
/// least squared distance to a marked one, as between corners alike. `side`: a brick's, along each axis.
void find_squared_distances(const BrickGrid& bricks, const std::array<double, 3>& side, std::size_t threads,
                            std::span<std::uint64_t> squared);

}  // namespace podm
