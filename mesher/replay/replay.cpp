#include "replay/replay.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include "delaunay/operation.h"
#include "delaunay/walk.h"
#include "podm/errors.h"
#include "replay/merge_logs.h"

namespace podm {

namespace {

constexpr double kTouching = 1e-100;  // mm

class Replay {
 public:
  explicit Replay(const OperationLog& log)
      : log_(log),
        mesh_(std::make_unique<Mesh>(Box{{box(0), box(1), box(2)}, {box(3), box(4), box(5)}}, capacity())),
        pool_(*mesh_),
        operation_(*mesh_, pool_, 0) {}

  std::unique_ptr<Mesh> run() {
    const std::uint32_t* removed = log_.all.removed.data();
    for (const LoggedOperation& logged : log_.all.operations) {
      apply(logged, removed);
      removed += logged.num_removed;
    }
    if (is_of_ranks())
      for (CellId c = 0; c < mesh_->cell_bound(); ++c)
        if (mesh_->cell(c).is_alive()) mesh_->make_canonical(c);
    return std::move(mesh_);
  }

 private:
  double box(std::size_t i) const { return log_.head.box[i]; }
  // Ranks have cells in common. The labels of these cells are those at canonical circumcenters.
  bool is_of_ranks() const { return log_.head.num_ranks > 1; }
  std::string name_of(const LoggedOperation& logged) const {
    const std::string text = operation_text(logged.sequence);
    const auto rank = static_cast<std::uint32_t>(log_.head.rank) + (logged.worker >> kBitsInWorker);
    return is_of_ranks() ? text + " of rank " + std::to_string(rank) : text;
  }
  // An insertion creates about 7 cells more than it destroys. A cavity may be filled before its cells are
  // free.
  std::size_t capacity() const {
    return std::min<std::size_t>(16 * log_.all.operations.size() + (1 << 20), kMostStoredCells);
  }

  void apply(const LoggedOperation& logged, const std::uint32_t* removed) {
    const auto check = [&](bool holds, const char* fault) {
      if (!holds) throw InputError(name_of(logged) + ": " + fault);
    };
    const Point p{logged.point[0], logged.point[1], logged.point[2]};
    const auto inside = [](double low, double x, double high) { return low < x && x < high; };
    check(inside(box(0), p.x, box(3)) && inside(box(1), p.y, box(4)) && inside(box(2), p.z, box(5)),
          "its point is outside the box");
    to_remove_.clear();
    for (std::uint32_t i = 0; i < logged.num_removed; ++i) {
      const auto found = vertex_of_.find(removed[i]);
      check(found != vertex_of_.end(), "removes a vertex that does not exist");
      to_remove_.push_back(found->second);
      vertex_of_.erase(found);
    }
    if (logged.kind == kMovedVertex) {
      check(to_remove_.size() == 1, "a move must name one vertex");
      check(vertex_of_.emplace(logged.vertex, to_remove_.front()).second, "its vertex exists already");
      return;
    }
    CellId& start = last_cell_[logged.worker];
    if (is_of_ranks() && logged.kind == kReceivedRemoval) {
      check(to_remove_.size() == 1 && mesh_->point(to_remove_.front()) == p,
            "a received removal must name the vertex at its point");
      remove(to_remove_.front(), walk(start, p));
      start = operation_.created().front();
      return;
    }
    const std::uint32_t sides = logged.kind >> kSidesInLog;
    const std::uint32_t kind_of_vertex = logged.kind % kReceivedInsertion,
                        kind_of_entry = logged.kind % (1u << kSidesInLog) - kind_of_vertex;
    check(kind_of_entry == 0 ||
              (is_of_ranks() && (kind_of_entry == kReceivedInsertion || kind_of_entry == kSeed)),
          "the kind of the entry is unknown");
    check(kind_of_entry == 0 || to_remove_.empty(), "a received vertex or a seed removes a vertex");
    check(operation_.plan_insertion(p, walk(start, p)) == StepResult::kDone,
          "its point conflicts with no cell");
    operation_.for_each_region_vertex([&](VertexId v, CellId seed) {
      if (std::find(to_remove_.begin(), to_remove_.end(), v) != to_remove_.end() && !operation_.removes(v))
        operation_.plan_removal(v, seed);
    });
    check(operation_.num_planned_removals() == to_remove_.size(),
          "removes a vertex that is not near its point");
    const auto is_kind = [&](VertexKind kind) { return kind_of_vertex == static_cast<std::uint32_t>(kind); };
    check(
        is_kind(VertexKind::kIsosurface) || is_kind(VertexKind::kCircumcenter) || is_kind(VertexKind::kLine),
        "the kind of its vertex is unknown");
    check(sides == 0 || log_.head.is_box_flat, "its vertex is on a side of the box, which is open");
    check(sides >> kNumSides == 0, "the sides of its vertex are unknown");
    const auto kind = static_cast<VertexKind>(kind_of_vertex);
    check(operation_.commit_insertion(p, kind, kTouching, static_cast<SideMask>(sides)) == StepResult::kDone,
          "its point is a vertex already");
    check(vertex_of_.emplace(logged.vertex, operation_.inserted()).second, "its vertex exists already");
    start = operation_.created().front();
  }

  void remove(VertexId v, CellId with_its_point) {
    if (operation_.plan_removal(v, with_its_point) != StepResult::kDone ||
        operation_.commit_removals() != StepResult::kDone)
      throw InternalError("a vertex cannot be removed");
  }

  // Starts from a cell of the same worker's last operation, which is near.
  CellId walk(CellId from, const Point& p) const {
    return cell_with(*mesh_, p, mesh_->cell(from).is_alive() ? from : last_created_alive());
  }

  CellId last_created_alive() const {
    const auto& created = operation_.created();
    const auto alive = [&](CellId c) { return mesh_->cell(c).is_alive(); };
    const auto found = std::find_if(created.begin(), created.end(), alive);
    if (found != created.end()) return *found;
    CellId c = 0;
    while (!alive(c)) ++c;
    return c;
  }

  const OperationLog& log_;
  std::unique_ptr<Mesh> mesh_;
  Pool pool_;
  Operation<NoLocks> operation_;
  std::unordered_map<std::uint32_t, VertexId> vertex_of_;  // by vertex number in the log
  std::unordered_map<std::uint32_t, CellId> last_cell_;    // by worker
  std::vector<VertexId> to_remove_;                        // removed by the present operation
};

}  // namespace

std::unique_ptr<Mesh> replay(const OperationLog& log) { return Replay(log).run(); }

}  // namespace podm
