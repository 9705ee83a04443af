#include "octree/leaf_region.h"

#include <limits>

namespace podm {

LeafRegion::LeafRegion(const Octree& octree, LeafId leaf) : octree_(&octree), leaf_(leaf) {
  const GridCube& cube = octree.cube(leaf);
  // Sides are aligned. The cubes that touch the leaf have sides of at least m <= side, so they contain all
  // points within m of it.
  std::int64_t m = cube.side;
  std::array<std::int64_t, 3> low, high, outer_low, outer_high;
  outer_low.fill(std::numeric_limits<std::int64_t>::max());
  outer_high.fill(0);
  for (const GridCube& part : octree.region(leaf)) {
    m = std::min<std::int64_t>(m, part.side);
    for (unsigned axis = 0; axis < 3; ++axis) {
      outer_low[axis] = std::min<std::int64_t>(outer_low[axis], part.corner[axis]);
      outer_high[axis] = std::max<std::int64_t>(outer_high[axis], part.corner[axis] + part.side);
    }
  }
  for (unsigned axis = 0; axis < 3; ++axis) {
    low[axis] = cube.corner[axis] - m;
    high[axis] = std::int64_t{cube.corner[axis]} + cube.side + m;
  }
  inner_ = grid_box(low, high);
  for (unsigned axis = 0; axis < 3; ++axis) {
    low[axis] = cube.corner[axis];
    high[axis] = low[axis] + cube.side;
  }
  own_ = grid_box(low, high);
  outer_ = grid_box(outer_low, outer_high);
  is_box_ = inner_ == outer_;
}

LeafRegion::GridBox LeafRegion::grid_box(const std::array<std::int64_t, 3>& low,
                                         const std::array<std::int64_t, 3>& high) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto from = [&](unsigned axis) {
    return low[axis] <= 0 ? -kInfinity : static_cast<double>(low[axis]);
  };
  const auto to = [&](unsigned axis) {
    return high[axis] >= octree_->grid_size()[axis] ? kInfinity : static_cast<double>(high[axis]);
  };
  return {{from(0), from(1), from(2)}, {to(0), to(1), to(2)}};
}

}  // namespace podm
