#include "distributed/learner.h"

#include <algorithm>
#include <bit>
#include <thread>
#include <utility>

#include "delaunay/lock_contract.h"
#include "delaunay/walk.h"
#include "geometry/point_hash.h"
#include "podm/errors.h"
#include "runtime/mix.h"
#include "runtime/parallel_for.h"
#include "runtime/parallel_sort.h"

namespace podm {

namespace {

constexpr double kTouching = 0;  // mm; the vertices come from a triangulation, so no two of them coincide

}  // namespace

struct Learner::Batch {
  const std::vector<LearntVertex>& changes;
  std::vector<std::size_t> order;
  std::uint32_t logged_kind;
};

// One thread's operation, and the cell where its next walk begins.
template <class Locks>
class Learner::OnThread {
 public:
  OnThread(Mesh& mesh, Pool& pool, WorkerId self, CommitOrder* order)
      : mesh_(mesh), operation_(mesh, pool, self), self_(self), order_(order) {}

  /// Makes the changes order[begin..end) of the batch. Those that meet another thread's lock are put off.
  void learn(const Batch& batch, std::size_t begin, std::size_t end) try {
    for (std::size_t i = begin; i < end; ++i) {
      if (!learn(batch.changes[batch.order[i]], batch.logged_kind)) {
        put_off_.push_back(batch.order[i]);
        std::this_thread::yield();  // the next change is near, and the other thread may still hold its locks
      }
      if (unlogged_.operations.size() >= kEntriesToFlush) flush_log();
    }
  } catch (...) {
    operation_.rollback();
    operation_.release();
    throw;
  }

  std::optional<CellId> find_cell(const std::array<Point, 4>& vertices);

  void flush_log() {
    if (order_ != nullptr) order_->log().append(unlogged_);
    unlogged_ = {};
  }
  std::vector<std::size_t> take_put_off() { return std::exchange(put_off_, {}); }
  std::vector<CellId> take_made() { return std::exchange(made_, {}); }
  void start_at(CellId near) { near_ = near; }
  CellId near() const { return near_; }
  /// Starts or ends the listing of the cells that the changes make.
  void list_made(bool is_listed) { lists_made_ = is_listed; }

 private:
  static constexpr std::size_t kEntriesToFlush = 4096;

  // False: another thread is in the way.
  bool learn(const LearntVertex& change, std::uint32_t logged_kind) {
    [[maybe_unused]] const AttemptScope scope(operation_.locks());
    const bool is_learnt = walk_to(change.point) && carry_out(change);
    if (is_learnt) {
      note(change, logged_kind);
      const std::vector<CellId>& created = operation_.created();
      if (lists_made_) made_.insert(made_.end(), created.begin(), created.end());
      // No rule examines these cells here. Each may rely on vertices of other cells.
      for (const CellId c : created) mesh_.set_relies_on_others(c, true);
      near_ = created.front();
    }
    operation_.release();
    return is_learnt;
  }

  // The cell near_ is reserved and contains the point.
  bool carry_out(const LearntVertex& change) {
    const bool is_gone = change.kind == VertexKind::kUnused;
    StepResult result = is_gone ? operation_.plan_removal(vertex_of(near_, change.point), near_)
                                : operation_.plan_insertion(change.point, near_);
    if (result == StepResult::kDone)
      result = is_gone ? operation_.commit_removals()
                       : operation_.commit_insertion(change.point, change.kind, kTouching);
    if (result == StepResult::kDone) return true;
    operation_.rollback();
    if (result != StepResult::kLockConflict)
      throw InternalError("vertices received from another rank do not fit in the mesh");
    return false;
  }

  VertexId vertex_of(CellId c, const Point& p) const {
    for (const VertexId v : mesh_.cell(c).vertices)
      if (mesh_.point(v) == p) return v;
    throw InternalError("a vertex to be removed does not exist");
  }

  bool reserve(CellId c) { return operation_.reserve(c, mesh_.stamp(c)) == StepResult::kDone; }

  // Reserves the cell of the last walk, or another one where that cell has died.
  bool reserve_start() {
    const CellId bound = mesh_.cell_bound();
    for (CellId tried = 0; tried < bound; ++tried, ++near_) {
      if (near_ >= bound) near_ = 0;
      if (mesh_.peek_is_alive(near_)) return reserve(near_);
    }
    return false;
  }

  // Reserves a cell that contains p. False: another thread holds a lock, or has replaced the next cell. A
  // walk does not go back at once. Cells around may have been replaced meanwhile, also by cells of the same
  // number. Therefore the last cell is looked at once more from all sides.
  bool walk_to(const Point& p) {
    if (!reserve_start()) return false;
    for (CellId previous = near_;;) {
      CellId next = next_towards(mesh_, p, near_, previous);
      if (next == near_ && Locks::kIsShared) next = next_towards(mesh_, p, near_, near_);
      if (next == near_) return true;
      const std::uint16_t stamp = mesh_.stamp(next);
      operation_.release();
      if (operation_.reserve(next, stamp) != StepResult::kDone) return false;
      previous = std::exchange(near_, next);
    }
  }

  // Logs under the locks, so that another thread's later change has a later number.
  void note(const LearntVertex& change, std::uint32_t logged_kind) {
    if (order_ == nullptr) return;
    const bool is_gone = change.kind == VertexKind::kUnused;
    const VertexId vertex = is_gone ? operation_.removed().front() : operation_.inserted();
    const Point& p = change.point;
    unlogged_.operations.push_back(
        {.sequence = order_->next(self_, operation_.created(), operation_.removed()),
         .point = {p.x, p.y, p.z},
         .vertex = vertex,
         .worker = self_,
         .kind = is_gone ? kReceivedRemoval : logged_kind + static_cast<std::uint32_t>(change.kind),
         .num_removed = is_gone ? 1u : 0u});
    if (is_gone) unlogged_.removed.push_back(vertex);
  }

  Mesh& mesh_;
  Operation<Locks> operation_;
  const WorkerId self_;
  CellId near_ = 0;
  std::vector<std::size_t> put_off_;
  bool lists_made_ = false;
  std::vector<CellId> made_;
  CommitOrder* order_;
  OperationBatch unlogged_;
};

// The centroid is in the cell, except for rounding in flat cells. Flat cells are found among the cells around
// the first vertex.
template <class Locks>
std::optional<CellId> Learner::OnThread<Locks>::find_cell(const std::array<Point, 4>& vertices) {
  const auto has = [&](CellId c, const Point& p) {
    const auto& all = mesh_.cell(c).vertices;
    return std::any_of(all.begin(), all.end(), [&](VertexId v) { return mesh_.point(v) == p; });
  };
  const auto is_it = [&](CellId c) {
    return std::all_of(vertices.begin(), vertices.end(), [&](const Point& p) { return has(c, p); });
  };
  const Vector sum = (vertices[1] - vertices[0]) + (vertices[2] - vertices[0]) + (vertices[3] - vertices[0]);
  walk_to(vertices[0] + 0.25 * sum);
  if (is_it(near_)) return near_;
  walk_to(vertices[0]);
  if (!has(near_, vertices[0])) return std::nullopt;
  const VertexId first = vertex_of(near_, vertices[0]);
  std::vector<CellId> around{near_};
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Cell& cell = mesh_.cell(around[i]);
    if (is_it(around[i])) return around[i];
    for (unsigned k = 0; k < 4; ++k) {
      if (cell.vertices[k] == first || cell.mirrors[k] == kNoFacet) continue;
      const CellId beside = cell_of(cell.mirrors[k]);
      if (std::find(around.begin(), around.end(), beside) == around.end()) around.push_back(beside);
    }
  }
  return std::nullopt;
}

Learner::Learner(Construction& construction, const CubeGrid& grid)
    : mesh_(construction.mesh()),
      grid_(grid),
      log_(construction.team().log),
      threads_(static_cast<std::size_t>(construction.num_workers())),
      finders_pool_(construction.pool(0)),
      alone_(
          std::make_unique<OnThread<NoLocks>>(mesh_, construction.pool(0), 0, construction.commit_order())) {
  for (WorkerId id = 0; threads_ > 1 && id < threads_; ++id)
    together_.push_back(std::make_unique<OnThread<VertexLocks>>(mesh_, construction.pool(id), id,
                                                                construction.commit_order()));
}

Learner::~Learner() = default;

// Inserts in rounds of random points, each with twice as many points as the previous one, and along a curve
// within each round. Neighbours in the order are near each other, and cavities are no larger than those of
// points in random order. (Amenta, Choi, Rote, SoCG 2003.)
std::vector<std::size_t> Learner::in_order(const std::vector<LearntVertex>& changes,
                                           std::vector<std::size_t>& round_ends) const {
  struct InOrder {
    int rounds_after;
    MortonCode code;
    std::size_t change;
    bool operator<(const InOrder& b) const {
      return rounds_after != b.rounds_after ? rounds_after > b.rounds_after : code < b.code;
    }
  };
  constexpr int kMostRounds = 10;
  constexpr std::size_t kLength = 1 << 12;
  std::vector<InOrder> places(changes.size());
  parallel_for_ranges(changes.size(), kLength, threads_,
                      [&](std::size_t begin, std::size_t end, std::size_t) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const Point& p = changes[i].point;
                          places[i] = {std::min(std::countl_zero(mix(PointHash()(p))), kMostRounds),
                                       grid_.place_on_curve(p), i};
                        }
                      });
  parallel_sort(places.begin(), places.end(), threads_);
  std::vector<std::size_t> order;
  order.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i > 0 && places[i].rounds_after != places[i - 1].rounds_after) round_ends.push_back(i);
    order.push_back(places[i].change);
  }
  round_ends.push_back(places.size());
  return order;
}

void Learner::learn(const std::vector<LearntVertex>& changes, std::uint32_t logged_kind,
                    std::vector<CellId>* made) {
  std::vector<std::size_t> round_ends;
  const Batch batch{changes, in_order(changes, round_ends), logged_kind};
  alone_->list_made(made != nullptr);
  for (const auto& one : together_) one->list_made(made != nullptr);
  std::size_t begin = 0;
  for (const std::size_t end : round_ends) {
    learn_on_threads(batch, begin, end);
    begin = end;
  }
  alone_->flush_log();
  if (made == nullptr) return;
  const auto add = [&](const std::vector<CellId>& more) {
    made->insert(made->end(), more.begin(), more.end());
  };
  add(alone_->take_made());
  for (const auto& one : together_) add(one->take_made());
}

// A thread takes a stretch of the curve at a time.
void Learner::learn_on_threads(const Batch& batch, std::size_t begin, std::size_t end) {
  constexpr std::size_t kStretch = 32, kLeastPerThread = 2 * kStretch;
  const std::size_t threads = std::min(together_.size(), (end - begin) / kLeastPerThread);
  if (threads < 2) return learn_alone(batch, begin, end);
  for (std::size_t t = 0; t < threads; ++t) together_[t]->start_at(alone_->near());
  parallel_for_ranges(end - begin, kStretch, threads,
                      [&](std::size_t from, std::size_t to, std::size_t thread) {
                        together_[thread]->learn(batch, begin + from, begin + to);
                      });
  Batch rest{batch.changes, {}, batch.logged_kind};
  for (std::size_t t = 0; t < threads; ++t) {
    together_[t]->flush_log();
    const std::vector<std::size_t> put_off = together_[t]->take_put_off();
    rest.order.insert(rest.order.end(), put_off.begin(), put_off.end());
  }
  num_put_off_ += rest.order.size();
  alone_->start_at(together_[0]->near());
  learn_alone(rest, 0, rest.order.size());
}

void Learner::learn_alone(const Batch& batch, std::size_t begin, std::size_t end) {
  alone_->learn(batch, begin, end);
  if (!alone_->take_put_off().empty()) throw InternalError("a vertex was not learnt");
}

std::optional<CellId> Learner::find_cell(const std::array<Point, 4>& vertices) {
  return alone_->find_cell(vertices);
}

// Nothing changes meanwhile, so that no thread needs locks.
std::vector<std::optional<CellId>> Learner::find_cells(
    std::size_t count, const std::function<const std::array<Point, 4>&(std::size_t)>& vertices_of) {
  constexpr std::size_t kStretch = 128;
  while (finders_.size() < threads_)
    finders_.push_back(std::make_unique<OnThread<NoLocks>>(mesh_, finders_pool_, 0, nullptr));
  for (const auto& finder : finders_) finder->start_at(alone_->near());
  std::vector<std::optional<CellId>> cells(count);
  parallel_for_ranges(count, kStretch, threads_, [&](std::size_t begin, std::size_t end, std::size_t thread) {
    for (std::size_t i = begin; i < end; ++i) cells[i] = finders_[thread]->find_cell(vertices_of(i));
  });
  return cells;
}

}  // namespace podm
