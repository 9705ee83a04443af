// Decides if a planned move is accepted: the conditions of R7, cheapest first.
#pragma once

#include <optional>
#include <vector>

#include "delaunay/vertex_move.h"
#include "geometry/dihedral.h"
#include "geometry/lens.h"
#include "podm/bounds.h"
#include "podm/counters.h"
#include "refine/rules.h"

namespace podm {

class MoveJudge {
 public:
  /// The move may be planned after construction. Oracle searches are counted in `counters`, and reads of the
  /// image and its transform in `reads`, if given.
  MoveJudge(VertexMove& move, const Isosurface& isosurface, const Parameters& parameters,
            const DihedralBounds& bounds, Counters& counters, const std::optional<CountedReads>& reads)
      : move_(move),
        rules_(move, isosurface, parameters, reads),
        parameters_(parameters),
        bounds_(bounds),
        counters_(counters) {}

  /// True if the vertex, which leaves `from`, keeps the spacing of I1 to I3 from all other vertices and is
  /// nearer to `from` than to any of them.
  bool keeps_spacing(const Point& from) const;
  /// True if the vertex is in the ball of no edge of a line. Both ends of such an edge would be vertices of
  /// its star.
  bool keeps_lines();
  /// The spacing required between vertices of these kinds, mm.
  double spacing_mm(VertexKind a, VertexKind b) const {
    const bool is_i1 = is_on_isosurface(a) && is_on_isosurface(b);
    return is_i1 ? parameters_.spacing_mm : kRadiusEdgeBound * parameters_.spacing_mm;
  }
  /// Returns the least quality of the planned cells inside the object, or none if one of them is below
  /// `least` or violates R4 or R5.
  std::optional<double> quality(double least);
  /// Returns the data that the rules need about a planned cell, or about one that stays.
  Examination examine(CellId c);
  /// Returns R1's sample, unless the vertices of the cell or of its neighbors cover it.
  std::optional<SurfacePoint> sample(const Examination& t) const { return rules_.r1_sample(t); }
  bool covers(VertexId v, const Point& z) const { return rules_.is_covered(z, v); }
  /// True if the cell violates none of R2 to R5.
  bool obeys_r2_to_r5(const Examination& t) const {
    return !rules_.r2_center(t) && !rules_.r3_surface_center(t) && !rules_.volume_rule(t);
  }
  /// For an isosurface vertex that leaves `from`, and a cell that stays: reaches() is true if the vertex may
  /// have covered a sample in the cell's ball, may_be_uncovered() if it may not cover such a sample from its
  /// new place, and was_covered() if it covered z.
  bool reaches(CellId c, const Point& from) const;
  bool may_be_uncovered(CellId c, const Point& from) const;
  bool was_covered(const Point& z, const Point& from) const;
  std::optional<SurfacePoint> on_isosurface(const Point& p, double radius_mm) const {
    return rules_.settled(p, radius_mm);
  }

 private:
  template <class Visit>
  bool all_of_planned(const Visit& visit) const;

  Ball ball_of(CellId c) const;
  /// Contains the samples that an isosurface vertex at p covers.
  Ball covered_from(const Point& p) const;

  VertexMove& move_;
  RulesOn<VertexMove> rules_;
  const Parameters& parameters_;
  const DihedralBounds& bounds_;
  Counters& counters_;
  std::vector<VertexId> on_lines_;  // scratch
};

}  // namespace podm
