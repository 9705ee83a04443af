// Traces the curves of one block where three or more labels meet.
//
// Labels at lattice points make the triangulated lattice a picture of the perturbed label function
// (lattice.h). In it curves are simple: a triangle with three labels is crossed once; a tetrahedron with
// three labels has two such triangles, which a piece of curve joins; one with four labels has four, and is a
// *hub* where four curves meet. So curves end nowhere inside, and pass from block to block. Their points are
// then moved to where the labels tie exactly. Features that are thinner than the lattice side may be missed,
// or make triangles without such a point nearby. These are the undecided places.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lines/block_grid.h"
#include "lines/chain_walk.h"
#include "lines/chains.h"
#include "lines/face_points.h"
#include "lines/lattice.h"
#include "lines/pieces.h"

namespace podm {

/// Traces blocks one after the other. Memory of one thread.
class BlockTracer {
 public:
  /// Keeps references. `counts` states for each label if it counts; it is empty if all do.
  BlockTracer(const BlockGrid& grid, const std::vector<bool>& counts)
      : grid_(grid), counts_(counts), keys_(grid.image().size) {
    index_of_triangle_.fill(-1);
  }

  /// Appends the pieces of a block, its joints on lower faces and inside, and its undecided places.
  void trace(const Voxel& block, Pieces& pieces);

 private:
  struct Triangle : ChainLinks {
    LatticeTriangle place;
    SlotMask labels;
    int joint = -1;  // if the triangle is on a face
  };

  void find_triangles();
  void add_tetrahedron(std::size_t lowest, unsigned second, unsigned third);
  std::int16_t triangle(std::size_t vertex, unsigned first_step, unsigned second_step, SlotMask labels);
  std::size_t face_of(const Triangle& t) const;
  void find_joints_on_faces();
  void add_joints_on_face(std::size_t face, std::vector<FaceTriangle> triangles);
  void add_joint_at_hub(std::size_t hub);
  FaceTriangle on_face(std::size_t index, std::size_t axis) const;
  void add_chain(const WalkedChain& walked);
  std::vector<Point> end_of(int joint) const;
  void find_missed(Pieces& pieces) const;
  SlotMask counting_slots() const;
  FewLabels labels_of(SlotMask slots) const;
  Point in_index_coordinates(const Point& f) const { return center(block_) + f; }

  const BlockGrid& grid_;
  const std::vector<bool>& counts_;
  JointKeys keys_;
  BlockLattice lattice_;
  // of the present block
  Voxel block_;
  BlockCorners corners_;
  WeightForms forms_;
  SlotMask counting_ = 0;
  LatticeRange range_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<std::int16_t, 4>> hubs_;  // the triangles of each
  std::vector<int> joint_of_hub_;
  BlockChains chains_;
  WalkedChain walked_;
  std::vector<Point> unconfirmed_;
  // by vertex and type: the triangle's index, or -1
  static constexpr std::size_t kTypes = 12;
  std::array<std::int16_t, kTypes * kLatticePoints> index_of_triangle_;
};

}  // namespace podm
