// The octree of PDR and PDR.PODM: cubes of space, of which some are the leaves that are refined one by one.
//
// The cubes tile the box. Those that the caller needs are leaves, in Morton order; the others are *gaps*:
// nobody refines them, but they still keep leaves apart. Cubes that touch, if only in a corner, differ by a
// factor of two in side at most. In a uniform tree, the common case, all are equal.
//
// Grid coordinates are mm from the box's low corner in units of the finest side. A cube owns
// [i, i+side) x [j, j+side) x [k, k+side) of them, and at the box's faces all that lies beyond too, so that
// every point of space is in exactly one cube.
//
// The *region* of a leaf L is all cubes that touch it, L included: the leaves among them are its first ring
// B1. Its second ring B2 is the leaves whose regions share a cube with L's. So leaves that are not within two
// rings of each other have no point of their regions in common, and operations that lock vertices in their
// own leaf's region only never meet. Gaps belong to regions because a vertex may lie in one: were rings made
// of leaves alone, leaves on either side of a gap could both reach into it.
#pragma once

#include <algorithm>
#include <functional>
#include <stop_token>
#include <vector>

#include "geometry/point.h"
#include "octree/balanced_cubes.h"

namespace podm {

using LeafId = std::uint32_t;
inline constexpr LeafId kNoLeaf = 0xffffffffu;

class Octree {
 public:
  /// These are asked of the cube [low, high], mm: which side a cube in there may have at most, and whether to
  /// make it a leaf.
  using LargestSide = std::function<double(const Point& low, const Point& high)>;
  using IsNeeded = std::function<bool(const Point& low, const Point& high)>;

  /// Tiles the box [low, high] with cubes whose sides are finest_side_mm times a power of two, as large as
  /// `largest_side` and balance allow, never smaller than the finest. A constant makes the tree uniform.
  /// InputError: an empty box, or a side that is not positive or of which the box takes more than 2^20.
  /// A stop request ends the asking: leaves are too few then, and cubes perhaps too large.
  Octree(const Point& low, const Point& high, double finest_side_mm, const LargestSide& largest_side,
         const IsNeeded& is_needed, const std::stop_token& stop = {});

  LeafId num_leaves() const { return static_cast<LeafId>(cube_of_leaf_.size()); }
  /// Leaves and gaps.
  std::size_t num_cubes() const { return cubes_.size(); }
  const GridCube& cube(LeafId leaf) const { return cubes_[cube_of_leaf_[leaf]]; }

  /// The grid coordinates of p, (p - origin()) / finest_side_mm() but for rounding.
  Point to_grid(const Point& p) const { return inverse_side_ * (p - origin_); }
  const Point& origin() const { return origin_; }
  double finest_side_mm() const { return finest_side_mm_; }
  /// The box, in cubes of the finest side.
  const GridPoint& grid_size() const { return size_; }

  /// The leaf that has the point; kNoLeaf in a gap and outside the box.
  LeafId leaf_at(const Point& p) const {
    const Point g = to_grid(p);
    const bool is_inside =
        g.x >= 0 && g.y >= 0 && g.z >= 0 && g.x <= size_[0] && g.y <= size_[1] && g.z <= size_[2];
    return is_inside ? leaf_of_cube_[cube_at(cell_at(g))] : kNoLeaf;
  }
  /// Whether the leaf's region has the point with grid coordinates g. LeafRegion is faster.
  bool is_in_region(LeafId leaf, const Point& g) const {
    return touch(cube(leaf), cubes_[cube_at(cell_at(g))]);
  }
  /// These answer in Morton order.
  std::vector<GridCube> region(LeafId leaf) const;
  std::vector<LeafId> first_ring(LeafId leaf) const;
  std::vector<LeafId> second_ring(LeafId leaf) const;

 private:
  using CubeId = std::uint32_t;  // leaves and gaps, in Morton order

  // The cubes in a part of the grid: consecutive in Morton order, or one, that may reach beyond the block.
  struct Block {
    CubeId first = 0;
    std::uint32_t count = 0;
  };

  GridPoint cell_at(const Point& g) const {
    const auto clamped = [](double x, std::uint32_t n) {
      return static_cast<std::uint32_t>(std::max(0.0, std::min(x, n - 1.0)));
    };
    return {clamped(g.x, size_[0]), clamped(g.y, size_[1]), clamped(g.z, size_[2])};
  }
  std::size_t block_at(const GridPoint& cell) const {
    const std::size_t x = cell[0] >> block_shift_, y = cell[1] >> block_shift_, z = cell[2] >> block_shift_;
    return (z * num_blocks_[1] + y) * num_blocks_[0] + x;
  }
  // One look-up in a dense table, faster than a search, and small: of uniform leaves there are some 10^5 at
  // most. The finest grid of a graded tree may be too large for a table; then blocks hold several cubes.
  CubeId cube_at(const GridPoint& cell) const {
    const Block& block = blocks_[block_at(cell)];
    return block.count == 1 ? block.first : search(block, cell);
  }
  CubeId search(const Block& block, const GridPoint& cell) const;
  Point to_mm(const GridCube& cube, std::uint32_t steps) const;
  void set_grid(const Point& low, const Point& high);
  void set_blocks();
  std::vector<CubeId> cubes_around(const GridCube& cube, std::uint32_t margin, std::uint32_t step) const;
  std::vector<CubeId> touching(CubeId cube) const;
  std::vector<CubeId> touching_region_of(CubeId cube) const;

  Point origin_;
  double finest_side_mm_, inverse_side_;
  GridPoint size_{};
  std::vector<GridCube> cubes_;
  bool is_uniform_ = false;
  std::vector<LeafId> leaf_of_cube_;
  std::vector<CubeId> cube_of_leaf_;
  unsigned block_shift_ = 0;
  GridPoint num_blocks_{};
  std::vector<Block> blocks_;
};

}  // namespace podm
