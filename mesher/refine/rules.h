// Rules R1..R5: what should be done about one cell. These functions only ask; attempt.h acts, R6 included.
//
// Foteinos, Chernikov, Chrisochoides, CGTA 47 (2014) 539-562. With t the cell, c its circumcentre, r its
// circumradius, z the isosurface point nearest to c:
//   R1  insert z if t meets the isosurface and no isosurface vertex is closer than delta to z
//   R2  insert c if t meets the isosurface and r >= 2 delta
//   R3  insert a restricted facet's surface centre if the facet has a vertex off the isosurface
//       or an angle of at most 30 degrees
//   R4  insert c if it is inside and radius-edge >= 1.93
//   R5  insert c if it is inside and r > r_t
//   R6  after R1 and R3, whose point is z: remove circumcentre vertices closer than 2 delta to z, or than
//       r_t is at z or at theirs, where a grid asks for small cells (size_grid.h)
// r_t is the label's, and at most what a grid asks for at c. What follows needs but its least value in the
// object, where all points of R4, R5 and R6 are: r_t from here on.
// Spacing. Let q = 1.93, k = sqrt(2 + sqrt(3)) = 1.93185, s = min(delta, r_t / k), and m the least distance
// of two isosurface vertices, or s where that is less. Isosurface vertices stay, so m never grows.
//   I2, I3  All other pairs are q m apart: R2 keeps 2 delta from every vertex, R6 that or r_t from free ones;
//           R5 keeps r_t >= k s, and R4 q times an edge, none of which is shorter than m.
//   I1      m >= s, but for what q < k costs. R1 keeps delta >= s. R3's ball is empty and no smaller than its
//           facet's circumcircle, whose radius is no less than a side if the facet has a small angle, and
//           q m / sqrt(3) if two of its vertices are free. If one is, the sides are at least q m, q m and m.
//           Right or obtuse triangles of such have radii above m. Those of acute ones shrink with each
//           side, at worst to m q^2 / sqrt(4 q^2 - 1), which is m for q = k, and 0.9991 m for 1.93.
// So the published 1.93, k rounded down, lets R4 insert a vertex up to 0.1 % nearer than k s (one in a
// thousand of R4's is), and R3 beside it a sample up to 0.09 % nearer than s, but only if three lengths are
// within 0.3 % of their least. The floor of worker.h ends any chain of these. Without such, m = s. So the
// process ends, on non-manifold interfaces too. Rules are tightened by kMargin (R5 by kGridMargin on a grid),
// which is more than rounded arithmetic errs, unless the object is a million radii from the origin.
#pragma once

#include <concepts>
#include <optional>

#include "delaunay/mesh.h"
#include "delaunay/vertex_move.h"
#include "isosurface/isosurface.h"
#include "sizing/size_field.h"

namespace podm {

inline constexpr double kMargin = 1e-9;  // relative

enum class Rule { kR1, kR2, kR3, kR4, kR5 };

struct Parameters {
  double delta_mm = 0;
  SizeField sizes;
  Box clamp_box;          // circumcentres beyond it are moved onto it, see virtual_box.h
  double spacing_mm = 0;  // s
  /// The initial mesh of PDR also bounds cells around the object: R5 holds outside too, with
  /// `shell_radius_mm`, for circumcentres up to `shell_mm` from the isosurface; both are less where a grid of
  /// sizes asks for smaller cells. 0: there is no such shell.
  double shell_mm = 0, shell_radius_mm = 0;
};

/// What the rules need to know of a cell, asked of the oracle once.
struct Examination {
  CellId cell;
  Point center;
  double squared_radius;
  LabelIndex label;            // the image's at the centre
  double isosurface_distance;  // a lower bound, from the centre
  bool is_distance_proven;     // else it rests on the nearest point found
  // z, if the circumball meets the isosurface and R1 or R2 may care
  std::optional<NearPoint> nearest;
  bool is_covered;  // z, by a vertex of the cell: R1 asks for nothing
  /// Whether R1 asks for nothing only if other vertices cover z.
  bool relies_on_others() const { return nearest && !is_covered; }
};

struct SurfaceCenter {
  Point point;
  CellId start;  // a cell in conflict with it
};

/// `Cells` is the mesh, or what an operation would make of it (delaunay/vertex_move.h).
template <class Cells>
class RulesOn {
 public:
  /// `reads`, if given, counts what the oracle reads for these rules.
  RulesOn(Cells& mesh, const Isosurface& isosurface, const Parameters& parameters,
          const std::optional<CountedReads>& reads = {});

  Examination examine(CellId c) const;
  /// Asks for what examine(c) will read of the mesh, the cell itself apart. Without locks it is a guess.
  void prefetch([[maybe_unused]] CellId c) const {
    if constexpr (std::same_as<Cells, Mesh>) isosurface_.prefetch(mesh_.peek_center(c));
  }

  /// R1's point, unless a vertex of the cell itself or of a neighbour already covers it. The caller must
  /// still look for isosurface vertices closer than delta among the point's cavity: the nearest one would be
  /// joined to it by a Gabriel edge, hence is among the cavity's vertices.
  std::optional<Point> r1_sample(const Examination& t) const;
  bool is_covered(const Point& z, VertexId by) const;
  /// The isosurface point nearest to p, if within `radius_mm`.
  std::optional<Point> settled(const Point& p, double radius_mm) const;
  std::optional<Point> r2_center(const Examination& t) const;
  std::optional<SurfaceCenter> r3_surface_center(const Examination& t) const;
  /// R4 and R5 insert the circumcentre.
  std::optional<Rule> volume_rule(const Examination& t) const;
  /// What R4 and R5 ask of a cell inside.
  bool has_poor_ratio(CellId c, double squared_radius) const;
  bool is_large(double squared_radius, LabelIndex label, const Point& center) const;
  /// Whether the cell asks for nothing. False may be said of one whose R1 sample is covered farther away.
  bool is_sound(CellId c) const;
  /// Whether R6 removes v when z is inserted.
  bool r6_removes(VertexId v, const Point& z) const;

  /// Label at the circumcentre, remembered in the store so that all cells around see the same.
  LabelIndex label_of(CellId c) const;

 private:
  // Answers are the same; a run that counts nothing pays for one test a question.
  template <class Question>
  auto ask(const Question& question) const {
    if (counted_) [[unlikely]]
      return question(*counted_);
    return question(isosurface_);
  }
  double distance_lower_bound(const Point& p, double radius) const;
  Cover covered_by(const Cell& cell) const;
  bool is_covered_beside(CellId c, const Point& z) const;
  bool may_be_restricted(const Examination& t, CellId neighbor) const;
  bool is_restricted(const Examination& t, CellId neighbor) const;
  bool obeys_r1_and_r2(const Cell& cell, double squared_radius) const;
  bool needs_sample(CellId c, unsigned facet) const;
  bool is_large_in_shell(const Examination& t) const;

  Cells& mesh_;
  const Isosurface& isosurface_;
  std::optional<Oracle<CountedReads>> counted_;
  const Parameters& parameters_;
  double squared_delta_, squared_two_delta_;
};

extern template class RulesOn<Mesh>;
extern template class RulesOn<VertexMove>;
using Rules = RulesOn<Mesh>;

}  // namespace podm
