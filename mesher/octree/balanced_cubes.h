// The coarsest balanced tiling of a grid by cubes, given which cubes are too large.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "octree/morton.h"

namespace podm {

struct GridCube {
  GridPoint corner{};
  std::uint32_t side = 1;  // a power of two that divides the corner
  friend bool operator==(const GridCube&, const GridCube&) = default;
};

/// Whether the closed cubes have a point in common.
inline bool touch(const GridCube& a, const GridCube& b) {
  for (unsigned axis = 0; axis < 3; ++axis)
    if (a.corner[axis] > b.corner[axis] + b.side || b.corner[axis] > a.corner[axis] + a.side) return false;
  return true;
}

/// Cubes in Morton order that tile [0, size), those at its far faces perhaps more. `is_too_large` is asked of
/// cubes of side 2 and more, of the parts of a cube only if it is too large; the answer may be true of cubes
/// that turn out smaller. Cubes that touch differ by a factor of two in side at most. If a stop is requested
/// before all is done, one cube.
std::vector<GridCube> balanced_cubes(const GridPoint& size,
                                     const std::function<bool(const GridCube&)>& is_too_large,
                                     const std::stop_token& stop = {});

}  // namespace podm
