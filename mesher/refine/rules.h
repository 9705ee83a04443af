// Rules R1 to R5: they decide what to do about one cell and change nothing. Worker (attempt.h) carries the
// operations out, R6 included.
//
// Foteinos, Chernikov, Chrisochoides, CGTA 47 (2014) 539-562. With t the cell, c its circumcenter, r its
// circumradius, z the isosurface point nearest to c:
//   R1  insert z if t meets the isosurface and no isosurface vertex is closer than delta to z
//   R2  insert c if t meets the isosurface and r >= 2 delta
//   R3  insert a restricted facet's surface center if the facet has a vertex off the isosurface
//       or an angle of at most 30 degrees
//   R4  insert c if it is inside and radius-edge >= 1.93
//   R5  insert c if it is inside and r > r_t
//   R6  after R1 and R3, whose point is z: remove circumcenter vertices closer than 2 delta to z and, where
//       a grid requests small cells (size_grid.h), closer than r_t at z and than r_t at the vertex
// r_t is the bound of the label, and at most the bound of the grid at c. From here on r_t is its least value
// in the object, which contains all points of R4, R5 and R6.
//
// Spacing. Let q = 1.93, k = sqrt(2 + sqrt(3)) = 1.93185, s = min(delta, r_t / k), and m the least distance
// of two isosurface vertices, at most s. R1 to R6 never remove isosurface vertices, so m never grows.
//   I2, I3  All other pairs are at least q m apart. R2 keeps 2 delta from every vertex. R6 keeps 2 delta or
//           r_t from free vertices. R5 keeps r_t >= k s. R4 keeps q times the length of an edge, and no edge
//           is shorter than m.
//   I1      m >= s, except for the loss due to q < k. R1 keeps delta >= s. R3's ball is empty and no smaller
//           than its facet's circumcircle. The radius of the circumcircle is no less than a side if the facet
//           has a small angle, and no less than q m / sqrt(3) if two of its vertices are free. If one vertex
//           is free, the sides are at least q m, q m and m. Right or obtuse triangles with such sides have
//           circumradii above m. The circumradius of an acute triangle shrinks with each side, at worst to
//           m q^2 / sqrt(4 q^2 - 1), which is m for q = k, and 0.9991 m for q = 1.93.
// The published bound 1.93 is k rounded down. It lets R4 insert a vertex up to 0.1 % nearer than k s (one in
// a thousand of R4's insertions does). It also lets R3 insert a sample beside that vertex up to 0.09 % nearer
// than s, but only if three lengths are within 0.3 % of their least values. kSpacingFloor ends any
// chain of such insertions. Without them m = s. Therefore refinement terminates, on non-manifold interfaces
// too. Rules are tightened by kMargin (R5 by kGridMargin on a grid), which exceeds the rounding errors unless
// the object is a million radii from the origin.
//
// Delta by place (sizing/delta_field.h). If thin layers are kept, delta is a function of the place with the
// Lipschitz constant L = 0.4 and the least value delta_0:
//   R1  keeps delta(z) from isosurface vertices
//   R2  applies if r is at least twice the smaller one of delta(c) and delta(z), and keeps r
//   R6  removes circumcenter vertices v closer to z than twice the smaller one of delta(z) and delta(v): with
//       delta(z) alone, samples where delta is large would remove vertices inserted where it is small
// The proof holds with s = min(delta_0, r_t / k): R1 keeps delta_0 >= s, R2 and R6 keep 2 delta_0, and R3 to
// R5 do not depend on delta. It also holds for a mesh that was refined before with larger deltas, as long as
// delta_0 is the same (algorithms/mend_topology.h): all rules kept at least as much then.
//   Cover: an isosurface point p has an isosurface vertex within 29 delta(p). It lies in the ball of a cell,
//   |p - c| <= r < 2 delta(c) as R2 does not apply, thus delta(c) < delta(p) + 2 L delta(c), which is
//   delta(c) < 5 delta(p), and needs L < 1/2. Further |c - z| <= |p - c| < 10 delta(p), and delta(z) <
//   delta(p) + 20 L delta(p) = 9 delta(p). R1 leaves a vertex within delta(z) of z. The sum is 10 + 10 + 9.
//   With one delta it is 5 delta. Termination does not depend on L.
//
// Flat box (isosurface/box_planes.h). Each sample has a set of sides that it is on. R3 also applies to a
// facet whose dual edge leaves a label through a side, unless all three vertices are on that side. Then the
// facets that end the object there lie in the plane: the dual edge of such a facet leads from a center in the
// box to one outside. R1 to R6 never move a vertex, and R7 keeps its sides.
//   Spacing. R3's ball is empty, and its radius is at least the facet's circumradius. If all three vertices
//   are samples, that is m / sqrt(3) or more, so each such insertion may leave 0.17 m. kSpacingFloorOfBox
//   ends a chain of them. It counts inside, too: the other rules keep what they keep in terms of m, whatever
//   m is, and cells beside small ones at sides need it. Edges of the box, and the curves in which
//   interfaces meet its sides, are sampled before R1 (algorithms/sample_box.h), at least 0.7 delta apart, so
//   that m begins at 0.7 s. R3's point moves to an edge, or to a curve with background beyond it, that is
//   within 0.7 of the ball's radius, and then keeps 0.3 of it. A point that stayed beside an edge would call
//   for the next one, nearer to it. As soon as all facets at the sides lie in their planes, the edges of the
//   box where the object touches them are edges of the mesh, and its corners vertices: the boundary is
//   closed, and facets in different planes can only meet there. The planes are reached, up to the floor. Let
//   a be a vertex off the side and z the point at which its facet leaves. If a is on another side, the edge
//   between the two is nearer to z than a is. If it is on an interface, it is 0.45 voxels or more from the
//   plane (BoxPlanes::snapped), or farther than R3 may move its point: half of the radius of an empty ball,
//   in all. Planes are tried one by one, the nearest first. Within half a voxel of the plane the interface
//   stands at right angles to it. Facets that the floor leaves off their side are counted
//   (Guarantees::off_sides).
// R4 makes sizes of cells grow away from places of small delta. How fast they grow is not proved, but
// measured.
//
// Lines (refine/line_keeper.h). If lines are kept, the vertices on them are isosurface vertices for all
// rules, and are never removed. Lines are sampled before R1. Let f = min(s, delta of lines) / 4.
//   R0  split an edge of a line, at the middle of its arc, (i) in place of a point of another rule in its
//       diametral ball; (ii) if another vertex of a cell with the edge is in that ball; (iii) if fewer than
//       three labels of its line are around it. Before (iii) insert the point where a side of the edge's
//       Voronoi polygon enters a missing label, if it is f or more from all vertices. An edge with an arc
//       shorter than f is not split. R6 applies after R0, too
//   R6  removes no vertex that is farther from z than twice the distance d of the nearest isosurface vertex
//       from z: samples near lines may be at a spacing down to f, and R4 would insert again what R6 removed
//   R3  near lines (near_lines.h) applies to angles of at most 20.7 degrees: the facet's circumradius is then
//       at least sqrt(2) sides
// An edge that cannot be split gives way to a point and may be lost. So a line never refuses a point, and the
// end of refinement means what it means without lines: no cell violates a rule. The bounds of R2, R4 and R5
// hold everywhere, and that of R3 is 20.7 degrees near lines and 30 elsewhere. Lost edges are listed.
//   Termination. A split cuts an arc of length f or more, and each part has a third of it or more: it is the
//   middle, or a shell around a node. Thus R0 splits finitely often. It also samples finitely often, as each
//   of these points keeps f from all vertices. From the last insertion of R0 on, R1 to R6 are as above: I2
//   and I3 hold, as R6 after R0 removes the same vertices as after R1, and what it leaves is 2 d >= 2 m from
//   z; m is what R0 has left, and R3 keeps at least a side. Near lines the spacing is thus proved to be f,
//   not s. Splits shorten m only a little. A point at distance d from the nearest vertex, in the ball of an
//   edge from u to w, sees the edge under at least a right angle: |u - w|^2 >= 2 d^2. Halves of a straight
//   edge keep d / sqrt(2). After R1 that is delta / sqrt(2), after R4 1.36 times the shortest edge of the
//   cell, after R3 near lines its shortest side. If R3 applied below 30 degrees near lines, too, a half would
//   keep 0.71 of a side, and the next facet beside it would do the same: a cascade down to f. R3 elsewhere,
//   and at facets with a free vertex, may shorten m in this way. No facet away from lines has these edges as
//   sides. Not proved is that lines are kept. Where two are nearer to each other than about f, edges are
//   lost.
//
// Lines in a flat box. Where an interface of two labels meets a side, they meet the background outside along
// a line in the side. Vertices on it are on that side. If one of the labels is background, or on an edge of
// the box, two labels are left. These curves are no lines: the bound of 30 degrees holds beside them. Samples
// of edges and curves come after those of lines, and leave out the balls of their edges.
//   R0 keeps kSpacingFloor between points that are on no side. Where lines run side by side, splits that go
//   further lose both.
//   R3 also applies to a facet between two labels that has a sample of a side where they do not meet, if R3's
//   ball has a radius of f or more: three labels would meet along an edge of the facet, away from lines.
//   It does not look at vertices of lines.
//   Termination. R0's points between labels move to sides as R3's points do, by at most half of the radius of
//   an empty ball. If a point would not keep f then, R0 splits the edge instead. R3's points for samples of
//   other labels keep f / 2 from all vertices. So there are finitely many of both. From the last one on, the
//   spacing is that of a flat box, where m is what they have left. The planes are reached. A vertex a of a
//   line may be as near to a side as R0 splits. Let a be exact. Within half a voxel of the side labels do not
//   change along the axis: the line stands at right angles to the plane, and a lies above its end n. A point
//   z of the plane is then nearer to n than to a. So a is no vertex of a facet that leaves at z: the ball of
//   R3 around z through a would not be empty. This needs n to be a vertex, and the exact end of its line.
//   Where n stands for several nodes, or a is not exact, the floor of the spacing counts.
#pragma once

#include <algorithm>
#include <concepts>
#include <memory>
#include <optional>

#include "delaunay/mesh.h"
#include "delaunay/vertex_move.h"
#include "isosurface/isosurface.h"
#include "refine/line_edges.h"
#include "runtime/shared_word.h"
#include "sizing/delta_field.h"
#include "sizing/size_field.h"

namespace podm {

inline constexpr double kMargin = 1e-9;  // relative
/// The invariants keep vertices s apart, up to a thousandth at a time, except at the sides of a flat box.
/// Only an oracle that errs about the nearest point can bring them much closer. An insertion nearer to a
/// vertex than this share of s is refused, so that refinement terminates for every image.
inline constexpr double kSpacingFloor = 0.1;
/// The same with a flat box, except for vertices of lines that are inside.
inline constexpr double kSpacingFloorOfBox = 0.02;
/// With a flat box the floor is also at most this share of the shortest side of a voxel: the curves at the
/// sides and the lines that end there need small cells, however large s is.
inline constexpr double kFloorOverVoxel = 0.1;

enum class Rule { kR1, kR2, kR3, kR4, kR5, kR0 };  // positions in Counters::insertions_by_rule

struct Parameters {
  double delta_mm = 0;  // if delta depends on the place, no delta is larger
  SizeField sizes;
  Box clamp_box;          // circumcenters beyond it are moved onto it, see virtual_box.h
  double spacing_mm = 0;  // s
  /// The initial mesh of PDR also bounds cells around the object: R5 holds outside, too, with
  /// `shell_radius_mm`, for circumcenters up to `shell_mm` from the isosurface. Both are less where a size
  /// grid requests smaller cells. 0: there is no such shell.
  double shell_mm = 0, shell_radius_mm = 0;
  std::shared_ptr<const DeltaField> deltas = nullptr;  // null: delta is the same everywhere
  LineEdges* lines = nullptr;                          // null: no lines are kept
  /// Insertions nearer to a vertex are refused.
  double least_spacing_mm() const { return kSpacingFloor * spacing_mm; }
  /// The same with a flat box. For vertices of lines it counts only if one of the two points is on a side.
  double least_spacing_in_box_mm(const LabelImage& image) const {
    return std::min(kSpacingFloorOfBox * spacing_mm, kFloorOverVoxel * std::ranges::min(image.spacing));
  }
};

/// The data that the rules need about a cell, requested from the oracle once.
struct Examination {
  CellId cell;
  Point center;
  double squared_radius;
  LabelIndex label;                // the image's at the center
  double isosurface_distance;      // a lower bound, from the center, mm
  bool is_distance_proven = true;  // otherwise it rests on the nearest point found
  // z, if the circumball meets the isosurface and R1 or R2 may apply
  std::optional<NearPoint> nearest;
  bool is_covered = false;  // z is covered by a vertex of the cell, so R1 does not apply
  /// True if R1 applies unless vertices of other cells cover z.
  bool relies_on_others() const { return nearest && !is_covered; }
};

struct SurfaceCenter {
  [[no_unique_address]] SurfacePoint point;  // `start` is in its padding
  CellId start;                              // a cell in conflict with it
};

/// The findings of R3 at the facets of a cell.
struct FacetSearch {
  std::optional<SurfaceCenter> center;
  FacetMask passing;  // facets on which R3 was tested and to which it does not apply
};

/// `Cells` is the mesh, or the cells that an operation plans (delaunay/vertex_move.h).
template <class Cells>
class RulesOn {
 public:
  /// `reads`, if given, counts what the oracle reads for these rules.
  RulesOn(Cells& mesh, const Isosurface& isosurface, const Parameters& parameters,
          const std::optional<CountedReads>& reads = {});

  Examination examine(CellId c) const;
  /// Prefetches what examine(c) reads first of the image and its transform. The center is read without locks
  /// and is therefore only a guess.
  void prefetch([[maybe_unused]] CellId c) const {
    if constexpr (std::same_as<Cells, Mesh>) isosurface_.prefetch(mesh_.peek_center(c));
  }

  /// Returns R1's point, unless a vertex of the cell itself or of a neighbor already covers it. R1 does not
  /// apply if the point is outside the cell's ball, which then only touches the isosurface: polishing has
  /// moved the point. Otherwise the caller must still look for isosurface vertices closer than delta among
  /// the vertices of the point's cavity: the nearest one would be joined to the point by a Gabriel edge and
  /// is therefore among them.
  std::optional<SurfacePoint> r1_sample(const Examination& t) const;
  bool is_covered(const Point& z, VertexId by) const;
  /// The squared distances from a sample, mm^2, below which is_covered() and r6_removes() may hold of a
  /// vertex.
  double squared_reach_of_cover() const { return squared_delta_; }
  double squared_reach_of_r6() const { return squared_two_delta_; }
  /// Returns the isosurface point nearest to p, if within `radius_mm`.
  std::optional<SurfacePoint> settled(const Point& p, double radius_mm) const;
  /// The same. A point on sides of a flat box stays there: it moves at most half a voxel, to where an
  /// interface or an edge of the box meets them.
  std::optional<SurfacePoint> settled_on_sides(const SurfacePoint& p, double radius_mm) const;
  /// Moves a point of the isosurface onto sides that are near enough for R3, whose empty ball around the
  /// point has this radius.
  SurfacePoint near_sides(const SurfacePoint& z, double radius_mm) const;
  std::optional<Point> r2_center(const Examination& t) const;
  std::optional<SurfaceCenter> r3_surface_center(const Examination& t) const {
    return search_all_facets(t).center;
  }
  /// Searches for a surface center up to the first facet that needs one.
  FacetSearch search_all_facets(const Examination& t) const { return search_facets(t, Facets::kAll); }
  /// The same, except at facets on which R3 was tested
  /// before, from one cell or the other (Mesh::facets_passing_r3).
  FacetSearch search_untested_facets(const Examination& t) const { return search_facets(t, untested_); }
  /// The first point on the way from one cell's center to another's where the label changes, and the label
  /// beyond it.
  struct Crossing {
    SurfacePoint point;
    LabelIndex beyond;
  };
  std::optional<Crossing> first_crossing(const Point& from, const Point& to) const;
  /// The point with one of two neighboring cells that is in conflict with it.
  std::optional<SurfaceCenter> in_conflict(const SurfacePoint& z, CellId c, CellId neighbor) const;
  /// Returns R4 or R5 if it applies; both insert the circumcenter.
  std::optional<Rule> volume_rule(const Examination& t) const;
  /// The conditions of R4 and R5 for a cell inside the object.
  bool has_poor_ratio(CellId c, double squared_radius) const;
  bool is_large(double squared_radius, LabelIndex label, const Point& center) const;
  /// True if no rule applies to the cell. May be false although a vertex farther away covers the cell's R1
  /// sample, or the cell's ball only touches the isosurface.
  bool is_sound(CellId c) const;
  /// True if R6 removes v when z is inserted.
  bool r6_removes(VertexId v, const Point& z) const;

  /// Returns the label at the circumcenter. It is kept in the store, so that all cells around see the same
  /// label.
  LabelIndex label_of(CellId c) const {
    const LabelIndex known = load(mesh_.label(c), std::memory_order_relaxed);
    return known != kUnknownLabel ? known : look_up_label(c);
  }

 private:
  // Both oracles give the same answers. A run that counts nothing and has an open box pays one branch per
  // question.
  template <class Question>
  auto ask(const Question& question) const {
    if (has_box_or_counts_) [[unlikely]]
      return ask_either(question);
    return question(Isosurface::OfOpenBox(isosurface_));
  }
  template <class Question>
  auto ask_either(const Question& question) const {
    return counted_ ? question(*counted_) : question(isosurface_);
  }
  LabelIndex look_up_label(CellId c) const;
  LabelAndBound label_and_bound(CellId c, double radius) const;
  double distance_lower_bound(const Point& p, double radius) const;
  Cover covered_by(const Cell& cell, double squared_delta) const;
  bool is_covered_beside(CellId c, const Point& z) const;
  FacetMask facets_tested_before(CellId c) const;
  bool may_be_restricted(const Examination& t, CellId neighbor) const;
  bool is_restricted(const Examination& t, CellId neighbor) const;
  enum class Facets { kAll, kUntested, kUntestedInBox };
  FacetSearch search_facets(const Examination& t, Facets facets) const;
  template <bool kInBox>
  FacetSearch search(const Examination& t, FacetMask tested) const;
  [[gnu::noinline]] FacetSearch search_in_box(const Examination& t, FacetMask tested) const {
    return search<true>(t, tested);
  }
  std::optional<SurfacePoint> change_on_dual_edge(const Examination& t, CellId neighbor) const;
  std::optional<SurfaceCenter> surface_center(const Examination& t, CellId neighbor) const;
  std::optional<SurfaceCenter> center_in_box(const Examination& t, CellId neighbor, unsigned facet) const;
  std::optional<SurfaceCenter> center_on_side(const Examination& t, CellId neighbor, unsigned facet) const;
  [[gnu::noinline]] SurfacePoint moved_to_sides(const SurfacePoint& z, double reach) const;
  SideMask common_sides(CellId c, unsigned facet) const;
  double reach_at(const Point& z, double share, CellId c, unsigned facet) const;
  bool obeys_r1_and_r2(const Cell& cell, double squared_radius, double squared_delta) const;
  // Only deltas by place need these functions. They are not inlined, so that runs with one delta pay no more
  // than branches.
  [[gnu::noinline]] double squared_delta_at(const Point& p) const;
  [[gnu::noinline]] double squared_delta_at_either(const Point& p, const Point& q) const;
  [[gnu::noinline]] double least_squared_delta(const Point& center, double radius) const;
  [[gnu::noinline]] bool is_covered_by_any(const Cell& cell, const Point& z) const;
  [[gnu::noinline]] std::optional<Point> r2_center_by_place(const Examination& t) const;
  bool needs_sample(CellId c, unsigned facet) const;
  bool has_foreign_sample(const Examination& t, CellId neighbor, unsigned facet) const;
  bool is_large_in_shell(const Examination& t) const;

  Cells& mesh_;
  const Isosurface& isosurface_;
  std::optional<Oracle<CountedReads>> counted_;
  const Parameters& parameters_;
  double squared_delta_, squared_two_delta_;  // of the largest delta
  bool has_deltas_;                           // delta depends on the place
  bool has_box_;                              // the box is flat
  bool has_box_or_counts_;
  Facets untested_;  // kUntested, or kUntestedInBox
};

extern template class RulesOn<Mesh>;
extern template class RulesOn<VertexMove>;
using Rules = RulesOn<Mesh>;

}  // namespace podm
