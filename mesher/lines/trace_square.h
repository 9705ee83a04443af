// Traces the curves on the sides of a flat box: where two labels meet on a side, and the box's edges as far
// as foreground touches them.
#pragma once

#include <array>
#include <vector>

#include "lines/block_grid.h"
#include "lines/chain_walk.h"
#include "lines/chains.h"
#include "lines/face_points.h"
#include "lines/lattice.h"
#include "lines/pieces.h"

namespace podm {

/// A side of the box: it is across an axis, at the lower or the upper end. Its number is its bit in `sides`.
struct BoxSide {
  std::size_t axis;
  bool is_upper;

  std::size_t u() const { return (axis + 1) % 3; }
  std::size_t v() const { return (axis + 2) % 3; }
  std::uint8_t bit() const { return static_cast<std::uint8_t>(1u << (2 * axis + is_upper)); }
};

inline constexpr std::array<BoxSide, 6> kBoxSides{
    {{0, false}, {0, true}, {1, false}, {1, true}, {2, false}, {2, true}}};

/// The labels and weights at the corners of a square, as a block that is constant along its third axis.
BlockCorners corners_of_square(const BlockGrid& grid, const BoxSide& side, int p, int q);

/// Traces the squares of the sides: the outer faces, in the middle of the outermost blocks. On a side the
/// label function is bilinear between voxels. Its triangulated lattice is that of the blocks, so that curves
/// of three labels end in the squares' joints. Memory of one thread.
class SquareTracer {
 public:
  /// Keeps a reference to `grid`.
  explicit SquareTracer(const BlockGrid& grid) : grid_(grid), keys_(grid.image().size) {
    index_of_edge_.fill(-1);
  }

  /// Appends the pieces of the square (p,q) of a side, each from -1 to the size - 1 along u and v, and its
  /// joints, except those on the edges of the box.
  void trace(const BoxSide& side, int p, int q, Pieces& pieces);

 private:
  // An edge of the lattice between two labels. It is a link between the triangles beside it.
  struct Edge : ChainLinks {
    std::uint16_t vertex;
    std::uint8_t step;  // 1: along u, 2: along v, 3: both
    SlotMask labels;
    int joint = -1;
  };

  void find_edges();
  void add_triangle(std::size_t vertex, unsigned middle_step);
  std::int16_t edge(std::size_t vertex, unsigned step);
  void find_joints();
  void add_joint_on_border(Edge& edge);
  void add_chain(const WalkedChain& walked);
  std::vector<Point> end_of(int joint) const;
  Point place_of(const Edge& edge) const;
  FewLabels labels_of(SlotMask slots) const;
  Point in_index_coordinates(const Point& uv) const;

  const BlockGrid& grid_;
  JointKeys keys_;
  BlockLattice lattice_;
  // of the present square
  BoxSide side_{};
  std::array<int, 2> place_{};
  WeightForms forms_;
  LatticeRange range_;  // along u and v
  std::vector<Edge> edges_;
  std::vector<FaceTriangle> triangles_;  // with three labels
  std::vector<int> joint_of_triangle_;
  BlockChains chains_;
  WalkedChain walked_;
  std::vector<Point> unconfirmed_;
  std::array<std::int16_t, 4 * kLatticeSlice> index_of_edge_;
};

/// Appends the pieces of all edges of the box, and all joints on them: corners, and places where labels
/// change.
void trace_box_edges(const BlockGrid& grid, Pieces& pieces);

}  // namespace podm
