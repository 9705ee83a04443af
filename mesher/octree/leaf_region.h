// Where the operations of an active leaf may lock vertices, and how large leaves must be for that to do.
//
// Reach of an operation for a cell t whose circumcentre c is in the leaf, if all circumradii are at most r.
// A cavity's cells have the inserted point p in their balls, hence their vertices within 2r of p.
//   R2 R4 R5   p = c, or p in t's ball if R2 moved it into the box          vertices within 3r of c
//   R1         p, the isosurface point nearest to c, is in t's ball         3r
//   R3         p is on the dual edge of a facet of t; an empty ball around
//              it, so of radius r at most, has the facet's vertices         |pc| <= 2r, 4r
//   R6         vertices within 2 delta of p go; their cells' vertices are
//              within 2r of them                                            2 delta more than the above
// So 4r + 2 delta from the leaf, and in uniform trees the region holds what is within one side of the leaf
// (where leaves are graded, within half a side at least). About r: an insertion does not raise the greatest
// circumradius, and a vertex that R6 removes leaves an isosurface vertex within 2 delta. So a ball that is
// empty now was, shrunk by 2 delta, empty in the initial mesh, and its radius is r_I + 2 delta at most if the
// initial mesh bounds all of them by r_I. It does not where it is far from the object.
//
// No safety rests on the side: what would lock a vertex outside the region has to be deferred. Then a cell
// that is replaced has all its vertices in the region, and one beside it, whose mirror is written, three; a
// cell cannot have three in each of two disjoint regions, nor be replaced by one operation and lie beside
// another. That holds wherever the inserted point is: the cells it gets have three such vertices too.
#pragma once

#include <array>

#include "octree/octree.h"

namespace podm {

/// The smallest side of uniform leaves, mm, at which no operation leaves its region when the circumradii of
/// the initial mesh are `initial_radius_mm` at most.
constexpr double leaf_side(double initial_radius_mm, double delta_mm) {
  const double radius = initial_radius_mm + 2 * delta_mm;
  return 4 * radius + 2 * delta_mm;
}

/// A leaf's region, quick to ask. The octree must outlive it.
class LeafRegion {
 public:
  LeafRegion(const Octree& octree, LeafId leaf);

  LeafId leaf() const { return leaf_; }
  /// Same as Octree::is_in_region of the point.
  bool contains(const Point& p) const {
    const Point g = octree_->to_grid(p);
    return inner_.has(g) || (!is_box_ && outer_.has(g) && octree_->is_in_region(leaf_, g));
  }
  /// Whether the point is in the leaf itself.
  bool owns(const Point& p) const { return own_.has(octree_->to_grid(p)); }
  const Octree& octree() const { return *octree_; }

 private:
  struct GridBox {
    Point low, high;  // half-open; unbounded at the faces of the octree's box
    bool has(const Point& g) const {
      return g.x >= low.x && g.x < high.x && g.y >= low.y && g.y < high.y && g.z >= low.z && g.z < high.z;
    }
    friend bool operator==(const GridBox&, const GridBox&) = default;
  };
  GridBox grid_box(const std::array<std::int64_t, 3>& low, const std::array<std::int64_t, 3>& high) const;

  const Octree* octree_;
  LeafId leaf_;
  GridBox own_;
  GridBox inner_, outer_;  // inner_ within the region within outer_
  bool is_box_;            // they are the same, as in uniform trees
};

}  // namespace podm
