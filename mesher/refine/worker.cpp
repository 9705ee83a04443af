#include "refine/worker.h"

namespace podm {

namespace {

// Invariants keep vertices s apart. Only an oracle that errs about the nearest point can bring them closer;
// far below s the insertion is refused, so that the process ends whatever the image.
constexpr double kSpacingFloor = 0.1;

}  // namespace

template <class Locks>
Worker<Locks>::Worker(Mesh& mesh, const Isosurface& isosurface, const Parameters& parameters)
    : mesh_(mesh),
      rules_(mesh, isosurface, parameters),
      pool_(mesh),
      operation_(mesh, pool_),
      min_distance_(kSpacingFloor * parameters.spacing_mm) {}

template <class Locks>
void Worker<Locks>::attempt() {
  mesh_.prefetch(poor_.upcoming(4));
  rules_.prefetch(poor_.upcoming(2));
  const PoorElementList::Entry entry = poor_.pop();
  if (mesh_.state(entry.cell).stamp != entry.stamp) {
    ++counters_.stale_cells;
    return;
  }
  ++counters_.classified_cells;
  apply_first_rule(entry.cell);
}

template <class Locks>
void Worker<Locks>::apply_first_rule(CellId c) {
  const Examination t = rules_.examine(c);
  if (const auto z = rules_.r1_sample(t)) {
    if (insert_on_isosurface(*z, c, Rule::kR1) == Sampled::kYes) return;
  }
  if (const auto p = rules_.r2_center(t)) return insert_circumcenter(*p, c, Rule::kR2);
  if (const auto center = rules_.r3_surface_center(t)) {
    const std::uint32_t stamp = mesh_.state(c).stamp;
    const Sampled sampled = insert_on_isosurface(center->point, center->start, Rule::kR3);
    if (sampled == Sampled::kYes && mesh_.state(c).stamp == stamp) give(c);
    return;
  }
  if (const auto rule = rules_.volume_rule(t)) insert_circumcenter(t.center, c, *rule);
}

// The point and its R6 removals are one operation.
template <class Locks>
auto Worker<Locks>::insert_on_isosurface(const Point& z, CellId start, Rule rule) -> Sampled {
  if (operation_.plan_insertion(z, start) != Outcome::kCommitted) {
    operation_.rollback();  // the ball only touches the isosurface at z
    return Sampled::kNo;
  }
  bool is_covered = false;
  if (rule == Rule::kR1) {
    operation_.for_each_region_vertex(
        [&](VertexId v, CellId) { is_covered = is_covered || rules_.is_covered(z, v); });
  }
  if (is_covered) {
    operation_.rollback();
    return Sampled::kCovered;
  }
  operation_.for_each_region_vertex([&](VertexId v, CellId seed) {
    if (rules_.is_doomed(v, z) && !operation_.removes(v)) operation_.plan_removal(v, seed);
  });
  return commit(z, VertexKind::kIsosurface, rule);
}

template <class Locks>
void Worker<Locks>::insert_circumcenter(const Point& p, CellId start, Rule rule) {
  if (operation_.plan_insertion(p, start) == Outcome::kCommitted) {
    commit(p, VertexKind::kCircumcenter, rule);
  } else {
    give_up();
  }
}

template <class Locks>
auto Worker<Locks>::give_up() -> Sampled {
  operation_.rollback();
  ++counters_.rejected;
  return Sampled::kNo;
}

template <class Locks>
auto Worker<Locks>::commit(const Point& p, VertexKind kind, Rule rule) -> Sampled {
  const std::size_t num_removed = operation_.num_removed();
  if (operation_.commit_insertion(p, kind, min_distance_) != Outcome::kCommitted) return give_up();
  counters_.removals += num_removed;
  ++counters_.insertions_by_rule[static_cast<std::size_t>(rule)];
  for (const CellId c : operation_.created()) give(c);
  if (poor_.is_due_for_cleaning()) poor_.drop_stale(mesh_);
  return Sampled::kYes;
}

template class Worker<NoLocks>;

}  // namespace podm
