// Computes the distance from each brick to the nearest marked brick. This is the exact Euclidean distance
// transform. It makes one pass per axis. Each pass takes the lower envelope of the parabolas that the
// previous pass left along a line (Maurer, Qi, Raghavan, PAMI 25 (2003) 265-270; Felzenszwalb, Huttenlocher,
// Theory of Computing 8 (2012) 415-428).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "image/voxel.h"

namespace podm {

/// `squared` holds the bits of a double per brick: 0 for a marked brick, infinity for any other. They are
/// replaced by the least squared distance to a marked brick, measured between equal corners of the two
/// bricks. `side` is the length of a brick along each axis.
void find_squared_distances(const BrickGrid& bricks, const std::array<double, 3>& side, std::size_t threads,
                            std::span<std::uint64_t> squared);

}  // namespace podm
