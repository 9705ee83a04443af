// Definitions of Worker's members. A source with its own type of locks includes this file and instantiates
// Worker for it. All other sources include worker.h.
#pragma once

#include "refine/r7_attempt.h"
#include "refine/worker.h"

namespace podm {

// A run with a single worker counts no accesses: it is on one node.
template <class Locks>
std::optional<AccessTally> Worker<Locks>::tally_for(const Mesh& mesh) {
  if (!Locks::kIsShared || mesh.num_nodes() == 1) return std::nullopt;
  return AccessTally(mesh.num_nodes());
}

template <class Locks>
std::optional<CountedReads> Worker<Locks>::reads_for(std::optional<AccessTally>& tally,
                                                     const ImageOwners* owners, NodeIndex node) {
  if (!tally || owners == nullptr || !owners->unavailable().empty()) return std::nullopt;
  return CountedReads(*owners, *tally, node);
}

template <class Locks>
Worker<Locks>::Worker(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters, WorkerId self,
                      Pool& pool, CommitOrder* order, const ImageOwners* owners)
    : mesh_(mesh),
      accesses_(tally_for(mesh)),
      isosurface_(isosurface),
      parameters_(parameters),
      reads_(reads_for(accesses_, owners, pool.node())),
      rules_(mesh, isosurface, parameters, reads_),
      operation_(mesh, pool, self, accesses_ ? &*accesses_ : nullptr),
      poor_(mesh.cell_capacity()),
      min_distance_(parameters.least_spacing_mm()),
      self_(self),
      order_(order) {
  if (parameters.lines != nullptr) lines_.emplace(mesh, rules_, operation_, *parameters.lines);
  if (order_ != nullptr) unlogged_.operations.reserve(kOperationsToFlush);
  if (order_ != nullptr) unlogged_.removed.reserve(kOperationsToFlush);
}

template <class Locks>
Outcome Worker<Locks>::attempt() try {
  [[maybe_unused]] const AttemptScope scope(operation_.locks());
  return attempt_next();
} catch (...) {
  operation_.rollback();
  operation_.release();
  throw;
}

template <class Locks>
Outcome Worker<Locks>::attempt_next() {
  if (unlogged_.operations.size() >= kOperationsToFlush) flush_log();
  look_ahead();
  const PoorElementList::Entry entry = poor_.pop();
  const Outcome outcome = try_entry(entry);
  if (outcome == Outcome::kLockConflict) {
    ++operation_.counters().lock_conflicts;
    poor_.push(entry.cell, entry.stamp);
  } else if (outcome == Outcome::kStaleCell) {
    ++operation_.counters().stale_cells;
  } else if (outcome == Outcome::kOutOfLeaf) {
    ++operation_.counters().out_of_leaf;
    deferred_.push_back(entry);
  }
  return outcome;
}

// Two thirds of the entries are stale and take no time. The look-ahead is therefore long, and data beyond a
// cell's own cache line is requested only if the cell is still alive.
template <class Locks>
void Worker<Locks>::look_ahead() {
  mesh_.prefetch(poor_.upcoming(kTurnsToCell).cell);
  const PoorElementList::Entry entry = poor_.upcoming(kTurnsToSurroundings);
  if (mesh_.stamp(entry.cell) != entry.stamp) return;
  mesh_.prefetch_surroundings(entry.cell);
  rules_.prefetch(entry.cell);
}

template <class Locks>
Outcome Worker<Locks>::try_entry(const PoorElementList::Entry& entry) {
  if (mesh_.stamp(entry.cell) != entry.stamp) return Outcome::kStaleCell;
  if (const StepResult reserved = operation_.reserve(entry.cell, entry.stamp); reserved != StepResult::kDone)
    return outcome_of(reserved);
  ++operation_.counters().classified_cells;
  const bool is_timed =
      Locks::kIsShared && operation_.counters().classified_cells % kAttemptsForOneTimed == 0;
  const auto start = is_timed ? std::chrono::steady_clock::now() : std::chrono::steady_clock::time_point();
  const Outcome outcome = perturbation_ ? apply_r7(entry.cell)
                          : lines_      ? apply_with_lines(entry.cell)
                                        : apply_first_rule(entry.cell);
  if (is_timed && outcome == Outcome::kLockConflict)
    operation_.counters().overhead.rollback_s +=
        kAttemptsForOneTimed *
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

template <class Locks>
Outcome Worker<Locks>::apply_first_rule(CellId c) {
  const Examination t = rules_.examine(c);
  if (!t.is_distance_proven) ++operation_.counters().oracle_searches;
  mesh_.set_relies_on_others(c, t.relies_on_others());
  if (const auto z = rules_.r1_sample(t)) {
    const Outcome sampled = insert_on_isosurface(*z, c, Rule::kR1);
    if (sampled != Outcome::kRejected) return sampled;
  }
  if (const auto p = rules_.r2_center(t)) return insert_circumcenter(*p, c, Rule::kR2);
  const FacetSearch search = rules_.search_untested_facets(t);
  if (search.center) {
    const std::uint16_t stamp = mesh_.stamp(c);
    const Outcome sampled = insert_on_isosurface(search.center->point, search.center->start, Rule::kR3);
    if (sampled == Outcome::kCommitted && mesh_.stamp(c) == stamp) give(c);
    // At a side of the box the floor of the spacing may forbid it. The other rules go on.
    if (sampled != Outcome::kRejected || !isosurface_.box()) return sampled;
  }
  mesh_.add_facets_passing_r3(c, search.passing);
  if (const auto rule = rules_.volume_rule(t)) return insert_circumcenter(t.center, c, *rule);
  return Outcome::kSound;
}

// A split in place of an insertion may leave the cell.
template <class Locks>
Outcome Worker<Locks>::apply_with_lines(CellId c) {
  const std::uint16_t stamp = mesh_.stamp(c);
  const std::optional<Outcome> split = apply_r0(c);
  const Outcome outcome = split ? *split : apply_first_rule(c);
  if (outcome == Outcome::kCommitted && mesh_.stamp(c) == stamp) give(c);
  return outcome;
}

// Returns nothing if R0 does not apply to the cell.
template <class Locks>
std::optional<Outcome> Worker<Locks>::apply_r0(CellId c) {
  if (const StepResult looked = lines_->look_in(c); looked != StepResult::kDone) return outcome_of(looked);
  if (lines_->has_found()) return split_line();
  const std::optional<SurfaceCenter> missing = lines_->sample_of_missing(c);
  if (!missing) return lines_->has_found() ? split_line() : std::nullopt;
  const Outcome sampled = insert_on_isosurface(missing->point, missing->start, Rule::kR3);
  return sampled == Outcome::kRejected ? std::nullopt : std::optional(sampled);
}

// Splits the edge that was found, in place of the insertion planned last. Returns nothing if it cannot be
// split; that plan has been rolled back, too.
template <class Locks>
std::optional<Outcome> Worker<Locks>::split_line() {
  operation_.rollback();
  StepResult planned = lines_->plan_split();
  if (planned == StepResult::kDone) planned = plan_r6_removals(lines_->point());
  if (planned != StepResult::kDone) {
    operation_.rollback();
    const Outcome outcome = outcome_of(planned);
    return outcome == Outcome::kRejected ? std::nullopt : std::optional(outcome);
  }
  const SurfacePoint& p = lines_->point();
  if (commit(p, VertexKind::kLine, Rule::kR0, p.sides) != Outcome::kCommitted) return std::nullopt;
  lines_->commit(operation_.inserted());
  return Outcome::kCommitted;
}

// Plans an insertion if no edge of a line is to be split instead. Otherwise `outcome` is that of the split.
template <class Locks>
StepResult Worker<Locks>::plan_beside_lines(const Point& p, CellId start, std::optional<Outcome>& outcome) {
  lines_->begin_search();
  StepResult planned = StepResult::kDone;
  while (planned == StepResult::kDone && lines_->is_encroached_by(p)) {
    outcome = split_line();
    if (outcome) return StepResult::kAtFloor;
    planned = operation_.plan_insertion(p, start);
  }
  return planned;
}

template <class Locks>
VertexId Worker<Locks>::insert_on_line(const SurfacePoint& p, CellId near) {
  StepResult planned = operation_.plan_insertion(p, cell_with(mesh_, p, near));
  if (planned == StepResult::kDone) planned = plan_r6_removals(p);
  if (planned != StepResult::kDone) operation_.rollback();
  const bool is_inserted =
      planned == StepResult::kDone && commit(p, VertexKind::kLine, Rule::kR0, p.sides) == Outcome::kCommitted;
  return is_inserted ? operation_.inserted() : kNoVertex;
}

template <class Locks>
bool Worker<Locks>::insert_sample(const SurfacePoint& z, CellId start, double least_mm) {
  bool is_near = operation_.plan_insertion(z, start) != StepResult::kDone;
  operation_.for_each_region_vertex_near(
      least_mm * least_mm, [&](VertexId v) { is_near = is_near || is_on_isosurface(mesh_.vertex(v).kind); });
  if (lines_ && !is_near) {
    lines_->begin_search();
    is_near = lines_->is_encroached_by(z);
  }
  const bool is_planned = !is_near && plan_r6_removals(z) == StepResult::kDone;
  if (!is_planned) operation_.rollback();
  return is_planned && commit(z, VertexKind::kIsosurface, Rule::kR1, z.sides) == Outcome::kCommitted;
}

template <class Locks>
void Worker<Locks>::begin_perturbation(const DihedralBounds& bounds, std::uint64_t seed) {
  perturbation_.emplace(mesh_, isosurface_, parameters_, rules_, operation_, bounds, seed, reads_);
}

template <class Locks>
Outcome Worker<Locks>::apply_r7(CellId c) {
  if (!perturbation_->is_poor(c)) return Outcome::kSound;
  if (const StepResult planned = perturbation_->plan(c); planned != StepResult::kDone) {
    operation_.rollback();
    if (planned == StepResult::kNoMove) kept_.push_back({{c, mesh_.stamp(c)}, perturbation_->obstacle()});
    return outcome_of(planned);
  }
  make_room_in_log();
  operation_.commit_move();
  ++operation_.counters().moves;
  record_commit(operation_.move().point(), operation_.move().kind(), operation_.move().sides());
  return Outcome::kCommitted;
}

// Inserts z and applies its R6 removals in one operation. kRejected: the point is already covered, or the
// ball only touches the isosurface there.
template <class Locks>
Outcome Worker<Locks>::insert_on_isosurface(const SurfacePoint& z, CellId start, Rule rule) {
  StepResult planned = operation_.plan_insertion(z, start);
  if (planned == StepResult::kDone && rule == Rule::kR1 && is_covered(z)) planned = StepResult::kCovered;
  if (lines_ && planned == StepResult::kDone) {
    std::optional<Outcome> split;
    planned = plan_beside_lines(z, start, split);
    if (split) return *split;
  }
  if (planned == StepResult::kDone) planned = plan_r6_removals(z);
  if (planned == StepResult::kDone) return commit(z, VertexKind::kIsosurface, rule, z.sides);
  operation_.rollback();
  return outcome_of(planned);
}

template <class Locks>
bool Worker<Locks>::is_covered(const Point& z) const {
  bool is_covered = false;
  operation_.for_each_region_vertex_near(rules_.squared_reach_of_cover(), [&](VertexId v) {
    is_covered = is_covered || rules_.is_covered(z, v);
  });
  return is_covered;
}

template <class Locks>
StepResult Worker<Locks>::plan_r6_removals(const Point& z) {
  const double squared_reach = lines_ ? squared_reach_of_r6_near_lines(z) : rules_.squared_reach_of_r6();
  const auto removes = [&](VertexId v) {
    return rules_.r6_removes(v, z) && (!lines_ || squared_distance(mesh_.point(v), z) < squared_reach);
  };
  bool is_due = false;
  operation_.for_each_region_vertex_near(squared_reach, [&](VertexId v) { is_due = is_due || removes(v); });
  StepResult planned = StepResult::kDone;
  if (!is_due) return planned;
  operation_.for_each_region_vertex([&](VertexId v, CellId seed) {
    if (planned == StepResult::kDone && removes(v) && !operation_.removes(v))
      planned = operation_.plan_removal(v, seed);
  });
  return planned;
}

// Twice the distance of the nearest isosurface vertex, if that is less than R6's reach (rules.h).
template <class Locks>
double Worker<Locks>::squared_reach_of_r6_near_lines(const Point& z) const {
  double squared_reach = rules_.squared_reach_of_r6();
  operation_.for_each_region_vertex_near(squared_reach / 4, [&](VertexId v) {
    if (is_on_isosurface(mesh_.vertex(v).kind))
      squared_reach = std::min(squared_reach, 4 * squared_distance(mesh_.point(v), z));
  });
  return squared_reach;
}

template <class Locks>
Outcome Worker<Locks>::insert_circumcenter(const Point& p, CellId start, Rule rule) {
  StepResult planned = operation_.plan_insertion(p, start);
  if (lines_ && planned == StepResult::kDone) {
    std::optional<Outcome> split;
    planned = plan_beside_lines(p, start, split);
    if (split) return *split;
  }
  if (planned == StepResult::kDone) return commit(p, VertexKind::kCircumcenter, rule);
  if (planned == StepResult::kNotInConflict) return give_up();
  operation_.rollback();
  return outcome_of(planned);
}

template <class Locks>
Outcome Worker<Locks>::give_up() {
  operation_.rollback();
  ++operation_.counters().rejected;
  return Outcome::kRejected;
}

template <class Locks>
Outcome Worker<Locks>::commit(const Point& p, VertexKind kind, Rule rule, SideMask sides) {
  make_room_in_log();
  if (operation_.commit_insertion(p, kind, min_distance_, sides) != StepResult::kDone &&
      !commit_in_box(p, kind, sides))
    return give_up();
  operation_.counters().removals += operation_.removed().size();
  ++operation_.counters().insertions_by_rule[static_cast<std::size_t>(rule)];
  record_commit(p, kind, sides);
  return Outcome::kCommitted;
}

// Commits an insertion that was refused, if the floor of a flat box allows it: splits of lines need a side.
template <class Locks>
bool Worker<Locks>::commit_in_box(const Point& p, VertexKind kind, SideMask sides) {
  if (!isosurface_.box()) return false;
  bool is_near = false, is_refused = false;
  operation_.for_each_region_vertex([&](VertexId v, CellId) {
    if (operation_.removes(v) || squared_distance(mesh_.point(v), p) >= min_distance_ * min_distance_) return;
    is_near = true;
    is_refused = is_refused || (kind == VertexKind::kLine && (sides | mesh_.vertex(v).sides) == 0);
  });
  const double floor_mm = parameters_.least_spacing_in_box_mm(isosurface_.image());
  return is_near && !is_refused && operation_.commit_insertion(p, kind, floor_mm, sides) == StepResult::kDone;
}

template <class Locks>
void Worker<Locks>::record_commit(const Point& p, VertexKind kind, SideMask sides) {
  if (order_ != nullptr) log(p, kind, sides);
  list_created();
  if (poor_.is_due_for_cleaning()) poor_.drop_stale(mesh_);
}

template <class Locks>
void Worker<Locks>::list_created() {
  for (const CellId c : operation_.created()) {
    if constexpr (requires(Locks & locks) { locks.region(); }) {
      if (!operation_.locks().region().owns(mesh_.cell(c).center)) {
        foreign_.push_back({c, mesh_.stamp(c)});
        continue;
      }
    }
    if (const unsigned home = homes_ == nullptr ? home_ : homes_->of(mesh_.cell(c).center); home != home_) {
      away_.push_back({home, {c, mesh_.stamp(c)}});
    } else {
      give(c);
    }
  }
}

// Runs before the commit, so that no operation is missing from the log when memory runs out.
template <class Locks>
void Worker<Locks>::make_room_in_log() {
  if (order_ == nullptr) return;
  unlogged_.removed.reserve(unlogged_.removed.size() + operation_.num_planned_removals());
}

template <class Locks>
void Worker<Locks>::log(const Point& p, VertexKind kind, SideMask sides) {
  const auto& removed = operation_.removed();
  unlogged_.operations.push_back({order_->next(self_, operation_.created(), removed),
                                  {p.x, p.y, p.z},
                                  operation_.inserted(),
                                  self_,
                                  static_cast<std::uint32_t>(kind) | std::uint32_t{sides} << kSidesInLog,
                                  static_cast<std::uint32_t>(removed.size())});
  unlogged_.removed.insert(unlogged_.removed.end(), removed.begin(), removed.end());
}

template <class Locks>
void Worker<Locks>::flush_log() {
  if (order_ == nullptr) return;
  order_->log().append(unlogged_);
  unlogged_.operations.clear();
  unlogged_.removed.clear();
}

}  // namespace podm
