// The insertion and removal of vertices that a rank learns, on all threads of the rank. A Delaunay
// triangulation whose ties are broken by coordinates is a function of its vertices. Therefore no rule is
// asked, and the order does not matter for the result.
//
// The threads lock vertices as workers do (delaunay/vertex_locks.h). A walk to a point reserves the cell that
// it is in. The next cell has three of that cell's vertices, therefore one of the two that are locked, and
// keeps its stamp until the walk releases them. A change that meets a lock of another thread is put off. One
// thread carries out all such changes after the others have ended. Each change is thus made once.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "algorithms/construction.h"
#include "delaunay/operation.h"
#include "distributed/cubes.h"
#include "podm/operation_log.h"

namespace podm {

/// A vertex that exists elsewhere, or one that has been removed there (kUnused).
struct LearntVertex {
  Point point;
  VertexKind kind;
};

class Learner {
 public:
  /// Learns on all threads of the construction's team. If the team has a log, it receives what is learnt.
  Learner(Construction& construction, const CubeGrid& grid);
  ~Learner();

  Mesh& mesh() { return mesh_; }
  const Mesh& mesh() const { return mesh_; }
  std::size_t threads() const { return threads_; }
  OperationLogWriter* log() const { return log_; }
  /// Inserts and removes these vertices. Insertions are logged as `logged_kind` plus the VertexKind. Adds the
  /// new cells to `made`, if given; some more than once, and including cells that die again.
  void learn(const std::vector<LearntVertex>& changes, std::uint32_t logged_kind, std::vector<CellId>* made);
  /// The number of changes so far that one thread made after the others.
  std::uint64_t num_put_off() const { return num_put_off_; }
  /// Returns the cell of the store that has these vertices, if there is one.
  std::optional<CellId> find_cell(const std::array<Point, 4>& vertices);
  /// Does the same for the vertices vertices_of(i), i < count, on all threads. The search is short if those
  /// of i and of i + 1 are near each other.
  std::vector<std::optional<CellId>> find_cells(
      std::size_t count, const std::function<const std::array<Point, 4>&(std::size_t)>& vertices_of);

 private:
  template <class Locks>
  class OnThread;
  struct Batch;

  std::vector<std::size_t> in_order(const std::vector<LearntVertex>& changes,
                                    std::vector<std::size_t>& round_ends) const;
  void learn_on_threads(const Batch& batch, std::size_t begin, std::size_t end);
  void learn_alone(const Batch& batch, std::size_t begin, std::size_t end);

  Mesh& mesh_;
  const CubeGrid& grid_;
  OperationLogWriter* log_;
  std::size_t threads_;
  std::uint64_t num_put_off_ = 0;
  Pool& finders_pool_;  // of operations that change nothing
  std::unique_ptr<OnThread<NoLocks>> alone_;
  std::vector<std::unique_ptr<OnThread<NoLocks>>> finders_;       // empty until cells are searched
  std::vector<std::unique_ptr<OnThread<VertexLocks>>> together_;  // empty if there is one thread
};

}  // namespace podm
