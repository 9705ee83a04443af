// The coarsest balanced tiling of a grid by cubes; a callback decides which cubes are too large.
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

/// True if the closed cubes have a point in common.
inline bool touch(const GridCube& a, const GridCube& b) {
  for (unsigned axis = 0; axis < 3; ++axis)
    if (a.corner[axis] > b.corner[axis] + b.side || b.corner[axis] > a.corner[axis] + a.side) return false;
  return true;
}

/// Returns cubes in Morton order that tile [0, size); cubes at its far faces may reach beyond. Calls
/// `is_too_large` for cubes of side 2 and more, and for the parts of a cube only if the cube is too large. It
/// may return true for cubes that do not appear in the result. The sides of cubes that touch differ at most
/// by a factor of two. Returns a single cube if a stop is requested before the tiling is complete.
std::vector<GridCube> balanced_cubes(const GridPoint& size,
                                     const std::function<bool(const GridCube&)>& is_too_large,
                                     const std::stop_token& stop = {});

}  // namespace podm
