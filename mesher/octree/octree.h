// The octree of PDR and PDR.PODM: cubes of space. Some of them are leaves, which are refined one by one.
//
// The cubes tile the box. Cubes that the caller needs are leaves, in Morton order; the others are *gaps*:
// they are not refined, but they still keep leaves apart. Sides of cubes that touch, even in a single corner,
// differ at most by a factor of two. In a uniform tree, the common case, all sides are equal.
//
// Grid coordinates are mm from the box's low corner in units of the finest side. A cube owns the coordinates
// [i, i+side) x [j, j+side) x [k, k+side); a cube at a face of the box also owns all points beyond the face.
// Every point of space is therefore in exactly one cube.
//
// The *region* of a leaf L is all cubes that touch it, L included. The leaves among them, except L, are its
// first ring B1. Its second ring B2 is the leaves whose regions share a cube with L's. Leaves that are not
// within two rings of each other therefore have disjoint regions, and operations that lock vertices only in
// their own leaf's region never meet. Gaps belong to regions because a vertex may lie in a gap: if rings
// consisted of leaves alone, leaves on either side of a gap could both reach into it.
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
  /// Callbacks for the cube [low, high], mm. LargestSide returns the largest side that a cube in there may
  /// have; IsNeeded returns true if the cube is to be a leaf.
  using LargestSide = std::function<double(const Point& low, const Point& high)>;
  using IsNeeded = std::function<bool(const Point& low, const Point& high)>;

  /// Tiles the box [low, high] with cubes whose sides are finest_side_mm times a power of two, as large as
  /// `largest_side` and balance allow, never smaller than the finest. A constant makes the tree uniform.
  /// Throws InputError if an extent of the box is negative, if the side is not positive, or if the box is
  /// more than 2^20 sides long. A stop request ends the calls of the callbacks: leaves may then be missing,
  /// and cubes may be too large.
  Octree(const Point& low, const Point& high, double finest_side_mm, const LargestSide& largest_side,
         const IsNeeded& is_needed, const std::stop_token& stop = {});

  LeafId num_leaves() const { return static_cast<LeafId>(cube_of_leaf_.size()); }
  /// Leaves and gaps.
  std::size_t num_cubes() const { return cubes_.size(); }
  const GridCube& cube(LeafId leaf) const { return cubes_[cube_of_leaf_[leaf]]; }

  /// Returns the grid coordinates of p: (p - origin()) / finest_side_mm(), up to rounding.
  Point to_grid(const Point& p) const { return inverse_side_ * (p - origin_); }
  const Point& origin() const { return origin_; }
  double finest_side_mm() const { return finest_side_mm_; }
  /// The extent of the box, in cubes of the finest side.
  const GridPoint& grid_size() const { return size_; }

  /// Returns the leaf that contains the point; kNoLeaf in a gap and outside the box.
  LeafId leaf_at(const Point& p) const {
    const Point g = to_grid(p);
    const bool is_inside =
        g.x >= 0 && g.y >= 0 && g.z >= 0 && g.x <= size_[0] && g.y <= size_[1] && g.z <= size_[2];
    return is_inside ? leaf_of_cube_[cube_at(cell_at(g))] : kNoLeaf;
  }
  /// True if the leaf's region contains the point with grid coordinates g. LeafRegion is faster.
  bool is_in_region(LeafId leaf, const Point& g) const {
    return touch(cube(leaf), cubes_[cube_at(cell_at(g))]);
  }
  /// These functions return cubes and leaves in Morton order.
  std::vector<GridCube> region(LeafId leaf) const;
  std::vector<LeafId> first_ring(LeafId leaf) const;
  std::vector<LeafId> second_ring(LeafId leaf) const;

 private:
  using CubeId = std::uint32_t;  // leaves and gaps, in Morton order

  // The cubes in a part of the grid: a consecutive run in Morton order, or a single cube that may reach
  // beyond the block.
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
  // A look-up in a dense table is faster than a search. The table is small: uniform trees have at most about
  // 10^5 leaves. The finest grid of a graded tree may be too large for a table; a block then holds several
  // cubes.
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
