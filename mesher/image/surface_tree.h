// The surface voxel nearest to any point: a tree of bricks, of bricks of bricks and so on, a bit for each of
// the 64 children that hold a surface voxel. For points too deep for the words of the feature transform.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "image/voxel.h"

namespace podm {

class SurfaceTree {
 public:
  SurfaceTree() = default;
  /// `masks`: the surface voxels, by brick. `spacing`: of voxels, mm.
  SurfaceTree(const BrickGrid& bricks, std::span<const std::uint64_t> masks,
              const std::array<double, 3>& spacing);

  bool is_empty() const { return levels_.empty() || levels_.back().masks[0] == 0; }

  /// Calls take(voxel, squared) for surface voxels whose centres are at most `squared_reach` from u, which is
  /// in voxels, the nearest among the first: all of them, unless `take` makes `squared_reach` less.
  /// `mask_of(brick)` tells the surface voxels of a brick that has some. Squares are of mm.
  template <class MaskOf, class Take>
  void visit(const Point& u, double& squared_reach, const MaskOf& mask_of, const Take& take) const {
    Search<MaskOf, Take>{*this, u, squared_reach, mask_of, take}.visit(levels_.size(), {0, 0, 0});
  }

 private:
  struct Level {
    BrickGrid nodes;
    std::vector<std::uint64_t> masks;
    std::uint64_t mask(const Voxel& node) const { return masks[nodes.index(node.i, node.j, node.k)]; }
  };
  template <class MaskOf, class Take>
  struct Search;

  std::vector<Level> levels_;  // the first has a bit a brick, the last is one node
  std::array<double, 3> spacing_{};
};

template <class MaskOf, class Take>
struct SurfaceTree::Search {
  const SurfaceTree& tree;
  Point from;
  double& squared_reach;
  const MaskOf& mask_of;
  const Take& take;

  // A node of level 0 is a brick, its children are voxels.
  void visit(std::size_t level, const Voxel& node) {
    const std::uint64_t mask = level == 0 ? mask_of(node) : tree.levels_[level - 1].mask(node);
    const std::array<double, 4> x2 = along(0, from.x, node.i, level), y2 = along(1, from.y, node.j, level),
                                z2 = along(2, from.z, node.k, level);
    std::array<double, 64> squared;
    double nearest2 = std::numeric_limits<double>::infinity();
    std::size_t nearest = 64;
    std::uint64_t rest = 0;
    for (std::uint64_t all = mask; all != 0; all &= all - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(all));
      squared[c] = x2[c & 3] + y2[c >> 2 & 3] + z2[c >> 4];
      if (squared[c] <= squared_reach) rest |= all & -all;
      if (squared[c] >= nearest2) continue;
      nearest2 = squared[c];
      nearest = c;
    }
    if (rest == 0) return;
    enter(level, node, nearest, nearest2);
    for (rest &= ~(std::uint64_t{1} << nearest); rest != 0; rest &= rest - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(rest));
      enter(level, node, c, squared[c]);
    }
  }

 private:
  /// Squared distances to the children of a node along one axis; they are 4^level voxels long.
  std::array<double, 4> along(std::size_t axis, double at, int node, std::size_t level) const {
    std::array<double, 4> squared;
    const double side = static_cast<double>(std::int64_t{1} << (2 * level));
    double low = 4 * side * node;
    for (double& s : squared) {
      const double d = tree.spacing_[axis] * std::max({0.0, low - at, at - (low + side - 1)});
      s = d * d;
      low += side;
    }
    return squared;
  }

  void enter(std::size_t level, const Voxel& node, std::size_t c, double squared) {
    if (squared > squared_reach) return;
    const Voxel child{4 * node.i + static_cast<int>(c & 3), 4 * node.j + static_cast<int>(c >> 2 & 3),
                      4 * node.k + static_cast<int>(c >> 4)};
    if (level > 0) return visit(level - 1, child);
    take(child, squared);
  }
};

}  // namespace podm
