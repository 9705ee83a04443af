// Whether a planned move is accepted: R7's conditions, in the order of what they cost.
#pragma once

#include <optional>
#include <span>

#include "delaunay/vertex_move.h"
#include "geometry/dihedral.h"
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

  /// The least quality of the planned cells that are inside; none if one of them is below `least`, or breaks
  /// R4 or R5.
  std::optional<double> quality(double least);
  /// Whether the planned cells break none of R1 to R5. `neighbors` are vertices around them, which may cover
  /// a sample of R1's.
  bool obeys_rules(std::span<const VertexId> neighbors);
  /// Whether a cell that stays asks for no sample, though the vertex has left `from`, on the isosurface.
  bool stays_covered(CellId c, const Point& from, std::span<const VertexId> neighbors);
  /// Whether a cell that stays may have had its sample covered from there.
  bool may_need(CellId c, const Point& from) const;
  std::optional<Point> on_isosurface(const Point& p, double radius_mm) const {
    return rules_.settled(p, radius_mm);
  }

 private:
  template <class Visit>
  bool all_of_planned(const Visit& visit) const;
  bool obeys_rules(CellId c, std::span<const VertexId> neighbors);

  VertexMove& move_;
  RulesOn<VertexMove> rules_;
  const Parameters& parameters_;
  const DihedralBounds& bounds_;
  Counters& counters_;
};

}  // namespace podm
