#include "refine/move_judge.h"

#include <algorithm>
#include <limits>
#include <span>

#include "refine/dihedral_quality.h"

namespace podm {

// Calls visit(CellId) for each planned cell that is not dug, until it returns false.
template <class Visit>
bool MoveJudge::all_of_planned(const Visit& visit) const {
  for (CellId c = VertexMove::kFirstPlanned; c < move_.end(); ++c)
    if (!move_.is_dug(c) && !visit(c)) return false;
  return true;
}

// It is enough to test the vertices of the star: the nearest vertex is one of them.
bool MoveJudge::keeps_spacing(const Point& from) const {
  const Point& p = move_.point();
  const double squared_step = squared_distance(from, p);
  for (CellId c = move_.first_of_star(); c < move_.end(); ++c) {
    for (const VertexId v : std::span(move_.cell(c).vertices).first(3)) {
      const double least = spacing_mm(move_.kind(), move_.vertex(v).kind);
      const double squared = squared_distance(move_.point(v), p);
      if (squared < least * least || squared <= squared_step) return false;
    }
  }
  return true;
}

bool MoveJudge::keeps_lines() {
  if (parameters_.lines == nullptr) return true;
  on_lines_.clear();
  for (CellId c = move_.first_of_star(); c < move_.end(); ++c)
    for (const VertexId v : std::span(move_.cell(c).vertices).first(3))
      if (move_.vertex(v).kind == VertexKind::kLine) on_lines_.push_back(v);
  const auto is_in_star = [&](VertexId v) {
    return std::find(on_lines_.begin(), on_lines_.end(), v) != on_lines_.end();
  };
  const Point& p = move_.point();
  return std::none_of(on_lines_.begin(), on_lines_.end(), [&](VertexId v) {
    bool is_in_ball = false;
    parameters_.lines->for_each_edge_of(v, [&](const LineEdge& edge) {
      const VertexId other = edge.first == v ? edge.last : edge.first;
      is_in_ball = is_in_ball || (is_in_star(other) && dot(move_.point(v) - p, move_.point(other) - p) < 0);
    });
    return is_in_ball;
  });
}

// Looks up a label only where the result depends on it.
std::optional<double> MoveJudge::quality(double least) {
  const double smallest = parameters_.sizes.smallest_squared_radius() * (1 - kGridMargin);
  double lowest = std::numeric_limits<double>::infinity();
  const bool is_good = all_of_planned([&](CellId c) {
    const double quality = dihedral_quality(move_, c, bounds_);
    const double squared_radius =
        squared_distance(move_.cell(c).center, move_.point(move_.cell(c).vertices[3]));
    const bool has_poor_ratio = rules_.has_poor_ratio(c, squared_radius);
    const bool may_be_refused = quality < least || has_poor_ratio || squared_radius > smallest;
    if (!may_be_refused && quality >= lowest) return true;
    const LabelIndex label = rules_.label_of(c);
    if (label == kBackground) return true;
    lowest = std::min(lowest, quality);
    return quality >= least && !has_poor_ratio &&
           !rules_.is_large(squared_radius, label, move_.cell(c).center);
  });
  return is_good ? std::optional(lowest) : std::nullopt;
}

Examination MoveJudge::examine(CellId c) {
  const Examination t = rules_.examine(c);
  if (!t.is_distance_proven) ++counters_.oracle_searches;
  return t;
}

Ball MoveJudge::ball_of(CellId c) const {
  const Cell& cell = move_.cell(c);
  return {cell.center, distance(cell.center, move_.point(cell.vertices[3])) * (1 + kMargin)};
}

// Avoids a square root and the read of a vertex. With d the distance of the centers and r and s the radii, d
// <= r + s if d^2 - r^2 - s^2 is not positive, or if its square is at most 4 r^2 s^2.
bool MoveJudge::reaches(CellId c, const Point& from) const {
  const Cell& cell = move_.cell(c);
  const double r2 = cell.squared_radius * (1 + 2 * kStoredSphereTolerance);
  const double s = covered_from(from).radius, s2 = s * s;
  const double beyond = squared_distance(cell.center, from) - r2 - s2;
  return !(beyond > 0 && beyond * beyond > 4 * r2 * s2);  // also true if the radius is NaN, not certified
}

// delta(z) >= delta(p) - L |z - p|, so |z - p| >= delta(z) implies (1 + L) |z - p| >= delta(p).
bool MoveJudge::may_be_uncovered(CellId c, const Point& from) const {
  const double least_mm =
      parameters_.deltas == nullptr
          ? parameters_.delta_mm * (1 - kMargin)
          : parameters_.deltas->at(move_.point()) * (1 - DeltaField::kMargin) / (1 + DeltaField::kSlope);
  return farthest_in_both(move_.point(), ball_of(c), covered_from(from)) >= least_mm;
}

bool MoveJudge::was_covered(const Point& z, const Point& from) const {
  const double delta_mm = parameters_.deltas == nullptr ? parameters_.delta_mm : parameters_.deltas->at(z);
  return distance(z, from) <= delta_mm * (1 + kMargin);
}

// delta(z) <= delta(p) + L |z - p|, so |z - p| < delta(z) implies (1 - L) |z - p| < delta(p).
Ball MoveJudge::covered_from(const Point& p) const {
  if (parameters_.deltas == nullptr) return {p, parameters_.delta_mm * (1 + kMargin)};
  return {p, parameters_.deltas->at(p) * (1 + DeltaField::kMargin) / (1 - DeltaField::kSlope)};
}

}  // namespace podm
