// The region in which operations of an active leaf may lock vertices, and the side that leaves need for it.
//
// Reach of an operation for a cell t whose circumcenter c is in the leaf, if all circumradii are at most r.
// The cells of a cavity have the inserted point p in their balls, therefore their vertices lie within 2r of
// p.
//   R2 R4 R5   p = c, or p in t's ball if R2 moved it into the box          vertices within 3r of c
//   R1         p, the isosurface point nearest to c, is in t's ball         3r
//   R3         p is on the dual edge of a facet of t; an empty ball around
//              it, of radius at most r, has the facet's vertices            |pc| <= 2r, 4r
//   R6         vertices within 2 delta of p are removed; the vertices of
//              their cells are within 2r of them                            2 delta more than the above
// An operation therefore reaches at most 4r + 2 delta from the leaf. In uniform trees the region contains all
// points within one side of the leaf; where leaves are graded, at least all points within half a side. The
// bound r has this reason: an insertion does not raise the greatest circumradius, and when R6 removes a
// vertex, an isosurface vertex within 2 delta remains. Therefore a ball that is empty now, shrunk by 2 delta,
// was empty in the initial mesh. Its radius is at most r_I + 2 delta if the initial mesh bounds all radii by
// r_I. The initial mesh does not bound them far from the object.
//
// Safety does not depend on the side: an operation that would lock a vertex outside the region has to be
// deferred. Then a replaced cell has all its vertices in the region, and a cell beside it, whose mirror is
// written, has three. A cell cannot have three vertices in each of two disjoint regions. It cannot be
// replaced by one operation and lie beside another operation's cells either. This holds wherever the inserted
// point is: its new cells have three such vertices too.
#pragma once

#include <array>

#include "octree/octree.h"

namespace podm {

/// Returns the smallest side of uniform leaves, mm, at which no operation leaves its region if the
/// circumradii of the initial mesh are at most `initial_radius_mm`.
constexpr double leaf_side(double initial_radius_mm, double delta_mm) {
  const double radius = initial_radius_mm + 2 * delta_mm;
  return 4 * radius + 2 * delta_mm;
}

/// A leaf's region with a fast membership test. The octree must outlive it.
class LeafRegion {
 public:
  LeafRegion(const Octree& octree, LeafId leaf);

  LeafId leaf() const { return leaf_; }
  /// Returns Octree::is_in_region for the point.
  bool contains(const Point& p) const {
    const Point g = octree_->to_grid(p);
    return inner_.has(g) || (!is_box_ && outer_.has(g) && octree_->is_in_region(leaf_, g));
  }
  /// True if the point is in the leaf itself.
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
  GridBox inner_, outer_;  // inner_ lies within the region, the region within outer_
  bool is_box_;            // inner_ and outer_ are equal, as in uniform trees
};

}  // namespace podm
