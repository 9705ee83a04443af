// Ranks tell each other vertices, not cells: a Delaunay triangulation whose ties are broken by coordinates is
// a function of its vertices. Vertices of a cube are told by the rank that wrote it last, all of them; who
// asks takes away and inserts what differs from its own. So nobody has to keep what it once told to whom.
#pragma once

#include <optional>

#include "delaunay/operation.h"
#include "distributed/communication.h"
#include "distributed/cubes.h"
#include "podm/operation_log.h"

namespace podm {

/// What one update took.
struct Update {
  std::uint64_t cubes = 0;          // that came
  std::uint64_t vertices_told = 0;  // that came in them
  std::uint64_t inserted = 0, removed = 0;

  Update& operator+=(const Update& b) {
    cubes += b.cubes;
    vertices_told += b.vertices_told;
    inserted += b.inserted;
    removed += b.removed;
    return *this;
  }
};

class VertexExchange {
 public:
  /// All ranks have the same mesh. The log, if there is one, is told what this rank learns.
  VertexExchange(Communication& ranks, Mesh& mesh, Pool& pool, const CubeGrid& grid, OperationLogWriter* log);

  /// From now on that rank has the cube's vertices as they are; all ranks have, until the first writer
  /// changes them.
  void note_writer(CubeId cube, int rank);
  /// Cubes of which this rank has all vertices as they are.
  CubeSet known() const;
  /// All ranks get the first one's mesh: collective. Nobody has noted a writer yet.
  void copy_first();
  /// Brings the vertices in these cubes up to date: collective, each rank names its own cubes. The cells that
  /// this makes are added to `made`, some more than once, those that die again among them.
  Update update(const CubeSet& wanted, std::vector<CellId>* made = nullptr);

  /// The cell of the store that has these vertices, if there is one.
  std::optional<CellId> find_cell(const std::array<Point, 4>& vertices);

 private:
  // A vertex, and a cell around it.
  struct Found {
    CellId cell;
    VertexId vertex;
  };
  std::optional<Found> find_vertex(const Point& p);
  struct ToldVertex {
    Point point;
    VertexKind kind;
  };
  struct Change {
    Point point;
    VertexKind kind;  // kUnused: removed
  };

  std::vector<Bytes> tell(const std::vector<Bytes>& asked) const;
  std::vector<Change> differences(const std::vector<Bytes>& told, Update& update) const;
  void apply(std::vector<Change>& changes, std::vector<CellId>* made);
  void note(const Change& change, VertexId vertex);
  void flush_log();
  CellId walk_to(const Point& p);

  Communication& ranks_;
  Mesh& mesh_;
  const CubeGrid& grid_;
  Operation<NoLocks> operation_;
  CellId near_ = 0;  // where the next walk begins
  OperationLogWriter* log_;
  OperationBatch unlogged_;
  struct State {
    int writer = 0;
    bool is_up_to_date = true;  // this rank's copy
  };
  std::vector<State> cubes_;
};

}  // namespace podm
