// Exchange of vertices between ranks. Cells need not be sent: a Delaunay triangulation whose ties are broken
// by coordinates is a function of its vertices. The rank that last wrote a cube sends all vertices of the
// cube. The requesting rank removes and inserts the vertices that differ from its own. No rank therefore has
// to remember what it sent earlier to which rank.
#pragma once

#include <optional>

#include "delaunay/operation.h"
#include "distributed/communication.h"
#include "distributed/cubes.h"
#include "podm/operation_log.h"

namespace podm {

/// The cost of one update.
struct Update {
  std::uint64_t cubes = 0;              // cubes received
  std::uint64_t vertices_received = 0;  // vertices received in them
  std::uint64_t inserted = 0, removed = 0;

  Update& operator+=(const Update& b) {
    cubes += b.cubes;
    vertices_received += b.vertices_received;
    inserted += b.inserted;
    removed += b.removed;
    return *this;
  }
};

class VertexExchange {
 public:
  /// All ranks must have the same mesh. If there is a log, it receives the vertices that this rank learns.
  VertexExchange(Communication& ranks, Mesh& mesh, Pool& pool, const CubeGrid& grid, OperationLogWriter* log);

  /// Notes that from now on this rank has the current vertices of the cube. Before the first writer changes
  /// them, all ranks have the current vertices.
  void note_writer(CubeId cube, int rank);
  /// Returns the cubes whose current vertices this rank has.
  CubeSet known() const;
  /// Copies the first rank's mesh to all ranks. Collective. No writer may have been noted before.
  void copy_first();
  /// Updates the vertices in these cubes. Collective; each rank passes its own cubes. Adds the cells that the
  /// update makes to `made`, some more than once, including cells that die again.
  Update update(const CubeSet& wanted, std::vector<CellId>* made = nullptr);

  /// Returns the cell of the store that has these vertices, if there is one.
  std::optional<CellId> find_cell(const std::array<Point, 4>& vertices);

 private:
  // A vertex, and a cell around it.
  struct Found {
    CellId cell;
    VertexId vertex;
  };
  std::optional<Found> find_vertex(const Point& p);
  struct SentVertex {
    Point point;
    VertexKind kind;
  };
  struct Change {
    Point point;
    VertexKind kind;  // kUnused: removed
  };

  std::vector<Bytes> answers_to(const std::vector<Bytes>& asked) const;
  std::vector<Change> differences(const std::vector<Bytes>& received, Update& update) const;
  void apply(std::vector<Change>& changes, std::vector<CellId>* made);
  void note(const Change& change, VertexId vertex);
  void flush_log();
  CellId walk_to(const Point& p);

  Communication& ranks_;
  Mesh& mesh_;
  const CubeGrid& grid_;
  Operation<NoLocks> operation_;
  CellId near_ = 0;  // start of the next walk
  OperationLogWriter* log_;
  OperationBatch unlogged_;
  struct State {
    int writer = 0;
    bool is_up_to_date = true;  // true if this rank's copy is current
  };
  std::vector<State> cubes_;
};

}  // namespace podm
