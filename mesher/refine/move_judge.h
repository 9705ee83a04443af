// Whether a planned move is accepted: R7's conditions, in the order of what they cost.
#pragma once

#include <optional>

#include "delaunay/vertex_move.h"
#include "geometry/dihedral.h"
#include "geometry/lens.h"
#include "podm/bounds.h"
#include "podm/counters.h"
#include "refine/rules.h"

namespace podm {

class MoveJudge {
 public:
  /// The move may be planned later. What oracles are asked for is counted in `counters`, and in `reads`, if
  /// given.
  MoveJudge(VertexMove& move, const Isosurface& isosurface, const Parameters& parameters,
            const DihedralBounds& bounds, Counters& counters, const std::optional<CountedReads>& reads)
      : move_(move),
        rules_(move, isosurface, parameters, reads),
        parameters_(parameters),
        bounds_(bounds),
        counters_(counters) {}

  /// Whether the vertex, which leaves `from`, keeps the spacing of I1 to I3 from all others, and is nearer to
  /// there than to any of them.
  bool keeps_spacing(const Point& from) const;
  /// What is to be between vertices of these kinds, mm.
  double spacing_mm(VertexKind a, VertexKind b) const {
    const bool is_i1 = a == VertexKind::kIsosurface && b == VertexKind::kIsosurface;
    return is_i1 ? parameters_.spacing_mm : kRadiusEdgeBound * parameters_.spacing_mm;
  }
  /// The least quality of the planned cells that are inside; none if one of them is below `least`, or breaks
  /// R4 or R5.
  std::optional<double> quality(double least);
  /// What the rules need to know of a planned cell, or of one that stays.
  Examination examine(CellId c);
  /// R1's sample, unless the cell's vertices or those of its neighbours cover it.
  std::optional<Point> sample(const Examination& t) const { return rules_.r1_sample(t); }
  bool covers(VertexId v, const Point& z) const { return rules_.is_covered(z, v); }
  /// Whether the cell breaks none of R2 to R5.
  bool obeys_r2_to_r5(const Examination& t) const {
    return !rules_.r2_center(t) && !rules_.r3_surface_center(t) && !rules_.volume_rule(t);
  }
  /// Of a vertex that leaves `from`, on the isosurface, and a cell that stays: whether it may have covered a
  /// sample in the cell's ball; whether it may not do so from where it goes; and whether it covered z.
  bool reaches(CellId c, const Point& from) const;
  bool may_be_uncovered(CellId c, const Point& from) const;
  bool was_covered(const Point& z, const Point& from) const {
    return distance(z, from) <= parameters_.delta_mm * (1 + kMargin);
  }
  std::optional<Point> on_isosurface(const Point& p, double radius_mm) const {
    return rules_.settled(p, radius_mm);
  }

 private:
  template <class Visit>
  bool all_of_planned(const Visit& visit) const;

  Ball ball_of(CellId c) const;
  Ball covered_from(const Point& p) const { return {p, parameters_.delta_mm * (1 + kMargin)}; }

  VertexMove& move_;
  RulesOn<VertexMove> rules_;
  const Parameters& parameters_;
  const DihedralBounds& bounds_;
  Counters& counters_;
};

}  // namespace podm
