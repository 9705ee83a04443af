// Finds the surface voxel nearest to any point. The tree consists of bricks, bricks of bricks and so on. Each
// node has a bit for each of its 64 children that contains a surface voxel. It serves points for which the
// feature transform stores no feature.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "image/voxel.h"

namespace podm {

class SurfaceTree {
 public:
  SurfaceTree() = default;
  /// `masks` holds the surface voxels by brick. `spacing` is that of the voxels, mm.
  SurfaceTree(const BrickGrid& bricks, std::span<const std::uint64_t> masks,
              const std::array<double, 3>& spacing);

  bool is_empty() const { return levels_.empty() || levels_.back().masks[0] == 0; }

  /// Calls take(voxel, squared) for the surface voxels whose centers are within sqrt(squared_reach) of u, the
  /// nearest among the first. It visits all of them unless `take` reduces `squared_reach`. `mask_of(brick)`
  /// returns the surface voxels of a brick that has some. u is in voxels, squares are in mm^2.
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

  std::vector<Level> levels_;  // the first level has one bit per brick, the last is one node
  std::array<double, 3> spacing_{};
};

template <class MaskOf, class Take>
struct SurfaceTree::Search {
  const SurfaceTree& tree;
  Point from;
  double& squared_reach;
  const MaskOf& mask_of;
  const Take& take;

  // A node of level 0 is a brick. Its children are voxels.
  void visit(std::size_t level, const Voxel& node) {
    const std::uint64_t mask = level == 0 ? mask_of(node) : tree.levels_[level - 1].mask(node);
    const Four x2 = along(0, from.x, node.i, level), y2 = along(1, from.y, node.j, level),
               z2 = along(2, from.z, node.k, level);
    std::array<Four, 16> squared;
    FourMasks in_reach{};
    for (unsigned row = 0; row < squared.size(); ++row) {
      squared[row] = x2 + y2[row & 3] + z2[row >> 2];
      in_reach |= (squared[row] <= squared_reach) & (kFirstRow << 4 * row);
    }
    const auto at = [&](std::size_t c) { return squared[c >> 2][c & 3]; };
    std::uint64_t rest =
        mask & static_cast<std::uint64_t>(in_reach[0] | in_reach[1] | in_reach[2] | in_reach[3]);
    if (rest == 0) return;
    auto nearest = static_cast<std::size_t>(std::countr_zero(rest));
    for (std::uint64_t others = rest & (rest - 1); others != 0; others &= others - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(others));
      nearest = at(c) < at(nearest) ? c : nearest;
    }
    enter(level, node, nearest, at(nearest));
    for (rest &= ~(std::uint64_t{1} << nearest); rest != 0; rest &= rest - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(rest));
      enter(level, node, c, at(c));
    }
  }

 private:
  // Values of the four children in a row along x.
  using Four [[gnu::vector_size(32)]] = double;
  using FourMasks [[gnu::vector_size(32)]] = std::int64_t;
  static constexpr FourMasks kFirstRow{1, 2, 4, 8};  // each child's own bit

  /// The squared distances to the children of a node along one axis. A child is 4^level voxels long.
  Four along(std::size_t axis, double at, int node, std::size_t level) const {
    const double side = static_cast<double>(std::int64_t{1} << (2 * level));
    const Four low = side * (4.0 * node + Four{0, 1, 2, 3});
    const Four below = low - at, above = at - (low + (side - 1)), outside = below > above ? below : above;
    const Four distance = tree.spacing_[axis] * (outside > 0 ? outside : Four{});
    return distance * distance;
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
