#include "refine/move_judge.h"

#include <algorithm>
#include <limits>

#include "refine/cell_quality.h"

namespace podm {

// Calls visit(CellId) for each, until it returns false.
template <class Visit>
bool MoveJudge::all_of_planned(const Visit& visit) const {
  for (CellId c = VertexMove::kFirstPlanned; c < move_.end(); ++c)
    if (!move_.is_dug(c) && !visit(c)) return false;
  return true;
}

// Labels are asked for where something depends on them.
std::optional<double> MoveJudge::quality(double least) {
  const double smallest = parameters_.sizes.smallest_squared_radius() * (1 - kMargin);
  double lowest = std::numeric_limits<double>::infinity();
  const bool is_good = all_of_planned([&](CellId c) {
    const double quality = cell_quality(move_, c, bounds_);
    const double squared_radius =
        squared_distance(move_.cell(c).center, move_.point(move_.cell(c).vertices[3]));
    const bool has_poor_ratio = rules_.has_poor_ratio(c, squared_radius);
    const bool may_be_refused = quality < least || has_poor_ratio || squared_radius > smallest;
    if (!may_be_refused && quality >= lowest) return true;
    const LabelIndex label = rules_.label_of(c);
    if (label == kBackground) return true;
    lowest = std::min(lowest, quality);
    return quality >= least && !has_poor_ratio && !rules_.is_large(squared_radius, label);
  });
  return is_good ? std::optional(lowest) : std::nullopt;
}

bool MoveJudge::obeys_rules(std::span<const VertexId> neighbors) {
  move_.glue_star();
  return all_of_planned([&](CellId c) { return obeys_rules(c, neighbors); });
}

// Its circumball has the sample.
bool MoveJudge::may_need(CellId c, const Point& from) const {
  const Cell& cell = move_.cell(c);
  const double radius = distance(cell.center, move_.point(cell.vertices[3]));
  return distance(cell.center, from) < (radius + parameters_.delta_mm) * (1 + kMargin);
}

bool MoveJudge::stays_covered(CellId c, const Point& from, std::span<const VertexId> neighbors) {
  const Examination t = rules_.examine(c);
  if (!t.is_distance_proven) ++counters_.oracle_searches;
  const auto z = rules_.r1_sample(t);
  if (!z || distance(*z, from) > parameters_.delta_mm * (1 + kMargin)) return true;
  return std::any_of(neighbors.begin(), neighbors.end(),
                     [&](VertexId v) { return rules_.is_covered(*z, v); });
}

bool MoveJudge::obeys_rules(CellId c, std::span<const VertexId> neighbors) {
  const Examination t = rules_.examine(c);
  if (!t.is_distance_proven) ++counters_.oracle_searches;
  if (const auto z = rules_.r1_sample(t)) {
    const bool is_covered =
        std::any_of(neighbors.begin(), neighbors.end(), [&](VertexId v) { return rules_.is_covered(*z, v); });
    if (!is_covered) return false;
  }
  return !rules_.r2_center(t) && !rules_.r3_surface_center(t) && !rules_.volume_rule(t);
}

}  // namespace podm
