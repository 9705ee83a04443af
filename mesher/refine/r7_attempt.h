// Definitions of Perturbation's members, included in the same way as those of Worker (attempt.h).
#pragma once

#include <algorithm>
#include <limits>

#include "refine/perturbation.h"

namespace podm {

template <class Locks>
StepResult Perturbation<Locks>::plan(CellId poor) {
  obstacle_ = Unmoved::kSpacing;
  const std::array<VertexId, 4> vertices = mesh_.cell(poor).vertices;
  for (const VertexKind kind : {VertexKind::kCircumcenter, VertexKind::kIsosurface}) {
    for (const VertexId v : vertices) {
      if (mesh_.vertex(v).kind != kind) continue;
      if (const StepResult planned = plan_of(v, poor); planned != StepResult::kNoMove) return planned;
      operation_.rollback();
    }
  }
  return StepResult::kNoMove;
}

// Takes the first point at which all cells are good and obey the rules, otherwise the best point that the
// rules allow.
template <class Locks>
StepResult Perturbation<Locks>::plan_of(VertexId v, CellId poor) {
  if (const StepResult planned = operation_.plan_move(v, poor); planned != StepResult::kDone)
    return planned == StepResult::kTooNear ? StepResult::kNoMove : planned;
  begin(v, poor);
  const double in_ball = least_quality_in_region(0);
  while (!points_.is_over()) {
    const auto p = next_point();
    if (!p) continue;
    if (const StepResult tried = try_point(*p, in_ball); tried != StepResult::kNoMove) return tried;
  }
  return choose();
}

template <class Locks>
void Perturbation<Locks>::begin(VertexId v, CellId poor) {
  neighbors_.clear();
  points_.neighbors().clear();
  candidates_.clear();
  operation_.for_each_region_vertex([&](VertexId w, CellId) {
    if (w == v || std::find(neighbors_.begin(), neighbors_.end(), w) != neighbors_.end()) return;
    neighbors_.push_back(w);
    points_.neighbors().push_back(
        {mesh_.point(w), judge_.spacing_mm(mesh_.vertex(v).kind, mesh_.vertex(w).kind)});
  });
  std::array<Point, 3> others;
  std::size_t count = 0;
  for (const VertexId w : mesh_.cell(poor).vertices)
    if (w != v) others[count++] = mesh_.point(w);
  points_.begin(mesh_.point(v), others, effort_);
}

// Projects the point of an isosurface vertex to the isosurface. A vertex stays on its sides of the box.
template <class Locks>
std::optional<Point> Perturbation<Locks>::next_point() {
  const Point p = points_.next(random_);
  if (operation_.move().kind() != VertexKind::kIsosurface) return points_.spaced(p);
  const auto settled = [&](const Point& of) -> std::optional<Point> {
    const std::optional<SurfacePoint> z = judge_.on_isosurface(of, points_.reach_mm());
    return z && z->sides == operation_.move().sides() ? std::optional<Point>(*z) : std::nullopt;
  };
  const auto first = settled(p);
  if (!first || points_.is_spaced(*first)) return first;
  const auto pushed = points_.spaced(*first);
  const auto second = pushed ? settled(*pushed) : pushed;
  return second && points_.is_spaced(*second) ? second : std::nullopt;
}

// Returns the least quality among the region's cells inside the object, from the cell number `first` on.
template <class Locks>
double Perturbation<Locks>::least_quality_in_region(std::size_t first) {
  double least = std::numeric_limits<double>::infinity();
  for (const CellId c : operation_.region_cells().subspan(first)) {
    const double quality = dihedral_quality(mesh_, c, bounds_);
    if (quality < least && rules_.label_of(c) != kBackground) least = quality;
  }
  return least;
}

// kDone: the point is accepted.
template <class Locks>
StepResult Perturbation<Locks>::try_point(const Point& p, double in_ball) {
  ++operation_.counters().points_tried;
  const StepResult planned = operation_.plan_move_to(p);
  if (planned != StepResult::kDone)
    return planned == StepResult::kNotInConflict ? StepResult::kNoMove : planned;
  if (!judge_.keeps_spacing(mesh_.point(operation_.move().vertex())) || !judge_.keeps_lines())
    return StepResult::kNoMove;
  obstacle_ = std::max(obstacle_, Unmoved::kShape);
  const double before = std::min(in_ball, least_quality_in_region(operation_.num_in_ball()));
  const auto quality = judge_.quality(std::min(1.0, before + kQualityStep));
  if (!quality) return StepResult::kNoMove;
  obstacle_ = Unmoved::kSurface;
  if (*quality >= 1) return obeys_rules();
  candidates_.push_back({p, *quality});
  return StepResult::kNoMove;
}

// Both functions return kDone if the cells violate no rule after the move, kNoMove if one does, and otherwise
// the result of the step that was not done.
template <class Locks>
StepResult Perturbation<Locks>::obeys_rules() {
  VertexMove& move = operation_.move();
  move.glue_star();
  for (CellId c = VertexMove::kFirstPlanned; c < move.end(); ++c) {
    if (move.is_dug(c)) continue;
    if (const StepResult obeys = obeys_rules(c); obeys != StepResult::kDone) return obeys;
  }
  return move.kind() == VertexKind::kIsosurface ? keeps_samples_covered() : StepResult::kDone;
}

template <class Locks>
StepResult Perturbation<Locks>::obeys_rules(CellId planned) {
  const Examination t = judge_.examine(planned);
  operation_.move().set_relies_on_others(planned, t.relies_on_others());
  if (const auto z = judge_.sample(t)) {
    if (const StepResult covered = is_covered(*z, planned); covered != StepResult::kDone) return covered;
  }
  return judge_.obeys_r2_to_r5(t) ? StepResult::kDone : StepResult::kNoMove;
}

// kDone: a vertex covers z, R1's sample for `start`, or the ball of `start` only touches the isosurface. R1
// does not apply to such a cell (Rules::r1_sample). If z were inserted, the isosurface vertex nearest to z
// would be joined to it. That vertex therefore belongs to a cell whose ball contains z.
template <class Locks>
StepResult Perturbation<Locks>::is_covered(const Point& z, CellId start) {
  const VertexMove& move = operation_.move();
  if (!move.is_in_conflict(start, z)) return StepResult::kDone;
  around_.clear();
  around_.add(start);
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const CellId c = around_[i];
    const auto& vertices = move.cell(c).vertices;
    if (std::any_of(vertices.begin(), vertices.end(), [&](VertexId v) { return judge_.covers(v, z); }))
      return StepResult::kDone;
    if (const StepResult reached = operation_.reach(c); reached != StepResult::kDone) return reached;
    operation_.for_each_neighbor(c, [&](CellId neighbor) {
      if (move.is_in_conflict(neighbor, z)) around_.add(neighbor);
    });
  }
  return StepResult::kNoMove;
}

// Examines the cells that stay and rely on vertices other than their own. The cells whose balls reach into
// the ball around the vertex's old position, in which the vertex covered samples, are connected with the
// planned cells.
template <class Locks>
StepResult Perturbation<Locks>::keeps_samples_covered() {
  const VertexMove& move = operation_.move();
  const Point from = mesh_.point(move.vertex());
  beyond_.clear();
  const auto add = [&](CellId c) {
    if (!VertexMove::is_planned(c) && judge_.reaches(c, from) && beyond_.add(c)) mesh_.prefetch_neighbors(c);
  };
  for (CellId c = VertexMove::kFirstPlanned; c < move.end(); ++c)
    if (!move.is_dug(c)) operation_.for_each_neighbor(c, add);
  for (std::size_t i = 0; i < beyond_.size(); ++i) {
    const CellId c = beyond_[i];
    if (const StepResult reached = operation_.reach(c); reached != StepResult::kDone) return reached;
    operation_.for_each_neighbor(c, add);
    if (!mesh_.relies_on_others(c) || !judge_.may_be_uncovered(c, from)) continue;
    const auto z = judge_.sample(judge_.examine(c));
    if (!z || !judge_.was_covered(*z, from)) continue;
    if (const StepResult covered = is_covered(*z, c); covered != StepResult::kDone) return covered;
  }
  return StepResult::kDone;
}

template <class Locks>
StepResult Perturbation<Locks>::choose() {
  std::sort(candidates_.begin(), candidates_.end(),
            [](const Candidate& a, const Candidate& b) { return a.quality > b.quality; });
  for (const Candidate& candidate : candidates_) {
    if (const StepResult planned = operation_.plan_move_to(candidate.point); planned != StepResult::kDone)
      return planned;
    if (const StepResult obeys = obeys_rules(); obeys != StepResult::kNoMove) return obeys;
  }
  return StepResult::kNoMove;
}

}  // namespace podm
