#include "optimize/optimizer.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "optimize/interface_hash.h"
#include "optimize/obstacles.h"
#include "optimize/peel.h"
#include "refine/dihedral_quality.h"

namespace podm {

namespace {

constexpr CellId kNoCell = 0xffffffffu;
constexpr std::array kSearchSizes{10u, 14u, 18u, 22u};  // vertices
// Larger cavities improve few cells within the bounds, 70 of a million on Colin27, and cost as much as all
// flips.
constexpr std::size_t kNumSizesWithinBounds = 1;
static_assert(kSearchSizes.back() + 2 <= CavitySearch::kMaxPoints);
constexpr double kNearlyGood = 0.6;  // just within bounds that are two thirds of the aim
// A new vertex's distance from a bad cell, as a multiple of the length of the cell's edges.
constexpr std::array kCandidateOffsets{0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9};

}  // namespace

template <class Locks>
Optimizer<Locks>::Optimizer(Mesh& mesh, const OptimizerParameters& parameters, WorkerId self, Pool& pool)
    : mesh_(mesh),
      parameters_(parameters),
      self_(self),
      cavity_(mesh, pool, self),
      flips_(mesh, parameters.aim, cavity_),
      smoothing_(parameters.aim),
      search_(parameters.aim) {}

template <class Locks>
Outcome Optimizer<Locks>::attempt() try {
  [[maybe_unused]] const AttemptScope scope(cavity_.locks());
  return attempt_next();
} catch (...) {
  cavity_.release();
  throw;
}

template <class Locks>
Outcome Optimizer<Locks>::attempt_next() {
  const Entry entry = listed_.back();
  listed_.pop_back();
  StepResult result = cavity_.reserve(entry.cell, entry.stamp);
  if (result == StepResult::kDone) {
    ++counters_.classified_cells;
    result = improve(entry.cell);
  }
  if (result == StepResult::kDone) return Outcome::kCommitted;
  const Outcome outcome = outcome_of(result);
  if (outcome == Outcome::kStaleCell) {
    ++counters_.stale_cells;
  } else if (outcome == Outcome::kLockConflict) {
    ++counters_.lock_conflicts;
    conflicts_.push_back(entry);
  } else {
    ++counters_.rejected;
    given_up_.push_back(entry);
  }
  return outcome;
}

template <class Locks>
StepResult Optimizer<Locks>::improve(CellId c) {
  const LabelIndex label = mesh_.label(c);
  attempted_ = {c, label, {parameters_.sizes, label}};
  if (const StepResult added = cavity_.add(c); added != StepResult::kDone) return added;
  if (pass_.is_for_cells_beyond_bound && dihedral_quality(mesh_, c, parameters_.bound) >= 1)
    return StepResult::kNotBetter;
  using Means = OptimizationMeans;
  StepResult result = StepResult::kNotBetter;
  const auto then = [&](bool is_allowed, const auto& step) {
    if (is_allowed && result != StepResult::kDone && result != StepResult::kLockConflict) result = step();
  };
  const bool may_help =
      pass_.means == Means::kFlips || !has_frozen_small_angle(mesh_, c, parameters_.aim.bounds());
  then(may_help, [&] { return flip(Means::kFlips); });
  then(may_help && pass_.means >= Means::kMoves, [&] { return move_a_vertex(); });
  then(may_help && pass_.means == Means::kSearches, [&] { return search(Means::kSearches, false); });
  then(may_help && pass_.means == Means::kAddedVertices, [&] { return search(Means::kAddedVertices, true); });
  then(pass_.means == Means::kPeels, [&] { return peel(); });
  return result;
}

template <class Locks>
void Optimizer<Locks>::commit(const std::vector<LocalCell>& cells, OptimizationMeans means) {
  const CellId c = attempted_.cell;
  const std::uint64_t change = share_of_interface_hash(mesh_, c, attempted_.label) -
                               share_of_interface_hash(mesh_, c, mesh_.label(c));  // 0 except for a peel
  cavity_.replace_by(cells, attempted_.label, VertexKind::kCircumcenter);
  interface_change_ += change;
  ++successes_[static_cast<std::size_t>(means)];
  counters_.cells_created += cavity_.created().size();
  if (attempted_.label == kBackground) return;
  for (const CellId made : cavity_.created())
    if (dihedral_quality(mesh_, made, parameters_.aim.bounds()) < 1)
      listed_.push_back({made, mesh_.stamp(made)});
}

template <class Locks>
StepResult Optimizer<Locks>::flip(OptimizationMeans means) {
  if (const StepResult planned = flips_.plan_best(attempted_); planned != StepResult::kDone) return planned;
  commit(flips_.new_cells(), means);
  return StepResult::kDone;
}

template <class Locks>
StepResult Optimizer<Locks>::move_a_vertex() {
  for (const VertexId v : std::array<VertexId, 4>(mesh_.cell(attempted_.cell).vertices)) {
    if (mesh_.vertex(v).kind != VertexKind::kCircumcenter) continue;
    const StepResult moved = move(v);
    if (moved == StepResult::kDone || moved == StepResult::kLockConflict) return moved;
  }
  return StepResult::kNotBetter;
}

// Moves a vertex whose cells all have one label.
template <class Locks>
StepResult Optimizer<Locks>::move(VertexId v) {
  cavity_.clear();
  if (const StepResult added = cavity_.add_ball(v, attempted_.cell, attempted_.label);
      added != StepResult::kDone)
    return added;
  const Local center = cavity_.local_of(v);
  boundary_.clear();
  for (std::size_t i = 0; i < cavity_.num_cells(); ++i) {
    const LocalCell& cell = cavity_.vertices(i);
    const auto k = static_cast<unsigned>(std::find(cell.begin(), cell.end(), center) - cell.begin());
    boundary_.push_back(facet_of(cell, k));
  }
  Point to = cavity_.point(center);
  const double floor = step_over(cavity_.worst(parameters_.aim));
  if (!smoothing_.move(cavity_.points(), boundary_, attempted_.bound, floor, to))
    return StepResult::kNotBetter;
  const Local moved = cavity_.add_point(to);
  new_cells_.clear();
  for (const LocalFacet& f : boundary_) new_cells_.push_back({f[0], f[1], f[2], moved});
  commit(new_cells_, OptimizationMeans::kMoves);
  return StepResult::kDone;
}

// Searches in larger and larger cavities.
template <class Locks>
StepResult Optimizer<Locks>::search(OptimizationMeans means, bool adds_vertex) {
  cavity_.clear();
  if (const StepResult added = cavity_.add(attempted_.cell); added != StepResult::kDone) return added;
  if (adds_vertex) {
    place_candidates();
  } else {
    candidates_.assign(1, std::nullopt);
  }
  search_.begin(attempted_.bound);
  const bool is_within = dihedral_quality(mesh_, attempted_.cell, parameters_.bound) >= 1;
  for (const std::size_t size :
       std::span(kSearchSizes).first(is_within ? kNumSizesWithinBounds : kSearchSizes.size())) {
    bool has_grown = false;
    if (const StepResult grown = grow(size, has_grown); grown != StepResult::kDone) return grown;
    if (!has_grown) break;
    if (fill_cavity(means)) return StepResult::kDone;
  }
  return StepResult::kNotBetter;
}

template <class Locks>
bool Optimizer<Locks>::fill_cavity(OptimizationMeans means) {
  cavity_.collect_boundary(boundary_);
  const double floor = step_over(cavity_.worst(parameters_.aim));
  for (const double wanted : {1.0, kNearlyGood, floor}) {
    if (wanted < floor) continue;
    for (const std::optional<Point>& candidate : candidates_) {
      const bool is_filled =
          search_.fill(cavity_.points(), candidate, boundary_, wanted, pass_.max_search_steps);
      counters_.conflict_tests += search_.num_steps();
      if (!is_filled) continue;
      if (candidate) cavity_.add_point(*candidate);
      commit(search_.cells(), means);
      return true;
    }
  }
  return false;
}

// Places candidates in the middle of the cell, and over and under it at fractions of its edges' length.
template <class Locks>
void Optimizer<Locks>::place_candidates() {
  const auto [a, b, c, d] = cavity_.points_of(cavity_.vertices(0));
  const Point center = 0.25 * (a + b + c + d);
  Vector normal{};
  for (const Vector& n : {cross(b - a, c - a), cross(b - a, d - c), cross(c - a, b - d), cross(d - a, c - b)})
    if (squared_length(n) > squared_length(normal)) normal = n;
  const double edge_length = std::pow(squared_length(normal), 0.25);
  candidates_.clear();
  for (const double offset : kCandidateOffsets) candidates_.push_back(center + offset / edge_length * normal);
}

// Adds cells of the label beside the cavity, as long as there are any, until it has `max_vertices` vertices.
template <class Locks>
StepResult Optimizer<Locks>::grow(std::size_t max_vertices, bool& has_grown) {
  has_grown = false;
  for (CellId next; (next = cell_beside_cavity(max_vertices)) != kNoCell; has_grown = true)
    if (const StepResult added = cavity_.add(next); added != StepResult::kDone) return added;
  return StepResult::kDone;
}

// Returns a cell without a new vertex, or a cell with the vertex that most cells beside the cavity have.
template <class Locks>
CellId Optimizer<Locks>::cell_beside_cavity(std::size_t max_vertices) {
  beside_.clear();
  for (std::size_t i = 0; i < cavity_.num_cells(); ++i) {
    for (const FacetId mirror : mesh_.cell(cavity_.cell(i)).mirrors) {
      if (mirror == kNoFacet) continue;
      const CellId c = cell_of(mirror);
      if (attempted_.label_of(mesh_, c) != attempted_.label || cavity_.has(c)) continue;
      const VertexId apex = mesh_.cell(c).vertices[static_cast<unsigned>(index_in_cell(mirror))];
      if (cavity_.has_vertex(apex)) return c;
      beside_.push_back({apex, c});
    }
  }
  CellId next = kNoCell;
  if (cavity_.num_vertices() >= max_vertices) return next;
  std::ptrdiff_t most = 0;
  for (const auto& [apex, c] : beside_) {
    const auto count = std::count_if(beside_.begin(), beside_.end(),
                                     [a = apex](const auto& other) { return other.first == a; });
    if (count <= most) continue;
    most = count;
    next = c;
  }
  return next;
}

template <class Locks>
StepResult Optimizer<Locks>::peel() {
  const AttemptedCell own = attempted_;
  for (const FacetId mirror : std::array<FacetId, 4>(mesh_.cell(own.cell).mirrors)) {
    const LabelIndex label = mirror == kNoFacet ? own.label : mesh_.label(cell_of(mirror));
    if (label == own.label) continue;
    const StepResult peeled = peel_to(label);
    if (peeled == StepResult::kDone || peeled == StepResult::kLockConflict) return peeled;
    attempted_ = own;
  }
  return StepResult::kNotBetter;
}

// Gives the cell to the label. The edge that comes to the interface, if any, must have cells of one label all
// around: it is on no interface yet. A cell that goes to the background leaves the object. A cell that goes
// to another label is replaced in the same operation by better cells.
template <class Locks>
StepResult Optimizer<Locks>::peel_to(LabelIndex label) {
  const Peel peel(mesh_, attempted_.cell, label);
  if (!may_be_peeled(mesh_, attempted_.cell, peel, parameters_.delta_mm)) return StepResult::kNotBetter;
  if (peel.num_coming == 2) {
    if (const StepResult walked = flips_.walk_ring(attempted_, peel.edge()); walked != StepResult::kDone)
      return walked;
  }
  attempted_ = {attempted_.cell, label, {parameters_.sizes, label}};
  if (label != kBackground) {
    const StepResult flipped = flip(OptimizationMeans::kPeels);
    if (flipped == StepResult::kDone || flipped == StepResult::kLockConflict) return flipped;
    return search(OptimizationMeans::kPeels, false);
  }
  cavity_.clear();
  if (const StepResult added = cavity_.add(attempted_.cell); added != StepResult::kDone) return added;
  new_cells_.assign(1, cavity_.vertices(0));
  commit(new_cells_, OptimizationMeans::kPeels);
  return StepResult::kDone;
}

template class Optimizer<NoLocks>;
template class Optimizer<VertexLocks>;

}  // namespace podm
