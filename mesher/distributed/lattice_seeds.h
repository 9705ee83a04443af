// The first vertices of a mesh on ranks: a coarse lattice, which is a function of position. Every rank can
// compute the vertices of any part of space, so none has to be sent.
//
// An octree divides a cube around the object and the space beside it. A cube of it is a leaf if its side is
// at most kSizeOverRadius times the bound on the circumradius there. It is also a leaf if the isosurface is
// farther than its corners and its label is unbounded, or background. This depends on the cube and on the
// image alone, so all ranks agree. The seeds are the corners and the centers of the leaves: a body-centered
// cubic lattice where leaves are equal. A corner or center of a cube that is no leaf is a corner of a smaller
// cube, and therefore a seed as well. A rank may therefore end the division far from its block, and has fewer
// seeds there, but no other ones.
//
//   Covering. Each point of a leaf with side S is within sqrt(5) / 4 S of a corner or of the center. The
//   circumball of a cell has no seed in it. If its center is in a leaf, its radius is therefore at most 0.56
//   S plus the jitter, whatever the sizes of the leaves around it. Leaves at the hull of the seeds lack the
//   seeds beyond it, and have larger balls. No proof rests on the size of balls: a rank inserts seeds
//   until the cells at its block are known (completion.h). Spacing. In a leaf the center is sqrt(3) / 2 S
//   from the corners. A corner of a smaller leaf that touches a leaf of side S is at least S / 2 from its
//   center. Seeds are therefore at least sqrt(3) / 2 of the least side apart, up to the jitter. With
//   kSizeOverRadius = 3 this is more than I3 requires (rules.h). R6 removes seeds near the isosurface, as it
//   removes circumcenters.
//
//   Hull. The balls of cells at the hull are nearly half-spaces. A rank with such a cell needs all seeds in
//   all cubes that the ball meets, the cubes along a whole face of the grid. Seeds therefore reach far beyond
//   the object, where leaves are large, and the grid begins there, too (kCubesAround in rounds.cpp).
//
// Each seed is moved by a small pseudo-random distance. Lattice points are degenerate: their conflict tests
// would be decided in exact arithmetic.
#pragma once

#include <cstdint>
#include <vector>

#include "algorithms/construction.h"
#include "algorithms/leaf_size.h"
#include "distributed/cubes.h"
#include "octree/morton.h"

namespace podm {

/// Returns a box around the clamp box, within its virtual box (refine/virtual_box.h).
inline Box box_of_seeds(const Box& clamp) { return grown(clamp, 0.2 * distance(clamp.low, clamp.high)); }

class LatticeSeeds {
 public:
  /// Keeps a reference to the problem. Seeds lie within `box`. `threads`: at least 1. Leaves may be `coarser`
  /// times as large as kSizeOverRadius says.
  LatticeSeeds(const Problem& problem, const Box& box, std::size_t threads, double coarser = 1);

  /// Returns all seeds in these cubes.
  std::vector<Point> in(const CubeSet& cubes) const;
  /// Returns some seeds, the fewer the farther they are from the box, and few of those in it.
  std::vector<Point> sparse_around(const Box& box) const;

 private:
  // A cube of the octree, in units of 2^-kMostDepth of the root's side.
  struct Node {
    GridPoint low;
    unsigned depth;
  };
  enum class Fate : std::uint8_t { kSkipped, kDivided, kTaken };

  double side_mm(const Node& node) const { return root_side_mm_ / (1u << node.depth); }
  Box box_of(const Node& node) const;
  bool is_leaf(const Node& node) const;
  Point point_of(MortonCode code) const;
  template <class FateOf, class IsWanted>
  std::vector<Point> collect(const FateOf& fate_of, const IsWanted& is_wanted) const;

  const Problem& problem_;
  const Box box_;
  const std::size_t threads_;
  const Radii radii_;
  const double side_over_radius_;
  Point root_low_;
  double root_side_mm_;
  double jitter_mm_;
};

}  // namespace podm
