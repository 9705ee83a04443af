// One operation on the triangulation: the insertion of a vertex, and with it the removal of others.
//
// An operation is cautious. *Reserving* locks two vertices of the cell that asks for it, enough to read it.
// *Planning* reads, locks and collects the region: the cells that will die. For an insertion these are the
// cells in conflict with the point (the cavity), for a removal the cells around the vertex (its ball); an
// isosurface insertion with its R6 removals takes their union. *Committing* replaces the region by new
// Delaunay cells. A plan that cannot be carried out is rolled back, with nothing written. *Releasing* unlocks
// all. Memory is asked for before the first write, so that std::bad_alloc from any step leaves a plan to roll
// back.
//
// Why one region serves all: a cell of the old triangulation stays Delaunay unless it holds a removed vertex
// or conflicts with the new one, so the region's boundary facets are facets of the new triangulation too.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "delaunay/hole.h"
#include "delaunay/mesh.h"
#include "delaunay/star.h"
#include "delaunay/vertex_locks.h"
#include "delaunay/vertex_move.h"
#include "podm/counters.h"

namespace podm {

/// Locks of a worker whose store may differ from the whole triangulation beyond a horizon
/// (distributed/zone.h): they tell which cells are of the whole, which may be read and replaced by an
/// operation around a point that their balls have, and where a vertex may be inserted, in a cell's ball.
template <class Locks>
concept HasHorizon = requires(Locks& locks, const Mesh& mesh, const Cell& cell, const Point& p) {
  { locks.knows(cell) } -> std::same_as<bool>;
  { locks.may_read(mesh, cell) } -> std::same_as<bool>;
  locks.begin_around(p);
  { locks.may_replace(mesh, cell) } -> std::same_as<bool>;
  { locks.may_insert(p, cell) } -> std::same_as<bool>;
};

template <class Locks>
class Operation {
 public:
  /// `tally`, if given, counts accesses to the mesh by the node whose pool made the cell or vertex. Locks
  /// that nobody shares count none: such a run is on one node.
  Operation(Mesh& mesh, Pool& pool, WorkerId self, AccessTally* tally = nullptr)
      : mesh_(mesh), pool_(pool), locks_(self), move_(mesh), tally_(tally) {}

  /// Locks two vertices of the cell c of that stamp, so that it and its neighbours may be read. kStaleCell:
  /// it has died. kLockConflict: conflicting_worker() tells with whom. kOutOfReach: it or a neighbour is
  /// beyond the horizon. Unless done nothing is held.
  StepResult reserve(CellId c, std::uint32_t stamp);
  void release() {
    forget_reads();
    locks_.unlock_all();
  }
  Locks& locks() { return locks_; }
  WorkerId conflicting_worker() const { return locks_.conflicting_worker(); }

  /// Digs the cavity of p from `start`, a cell in conflict with p, reserved or beside it. Unless done the
  /// caller must roll back. kNotInConflict: `start` is not. The plan may be extended by plan_removal.
  StepResult plan_insertion(const Point& p, CellId start);
  /// Adds the ball of v, a vertex of the cell `seed`, to the region.
  StepResult plan_removal(VertexId v, CellId seed);
  /// Calls visit(VertexId, CellId) for the vertices of every cell of the region, some more than once. `visit`
  /// may extend the plan; the cells so added are visited too.
  template <class Visit>
  void for_each_region_vertex(Visit&& visit) const {
    for (std::size_t i = 0; i < region_.cells.size(); ++i) {
      const std::array<VertexId, 4> vertices = mesh_.cell(region_.cells[i]).vertices;
      for (const VertexId v : vertices) visit(v, region_.cells[i]);
    }
  }
  bool removes(VertexId v) const;

  /// Plans the move of v, a vertex of the cell `seed`, to places that are still to be tried: v's ball is the
  /// region. kTooNear: it has too many vertices. Unless done the caller must roll back.
  StepResult plan_move(VertexId v, CellId seed);
  /// Plans the move to p, instead of where it was planned to before: move() has the cells. p is nearer to
  /// where the vertex is than to all others. Unless done the caller must roll back; kNotInConflict: or try
  /// another point.
  StepResult plan_move_to(const Point& p);
  VertexMove& move() { return move_; }
  /// Locks two vertices of c, which may be read already: then so may its neighbours. kOutOfReach: one of them
  /// is beyond the horizon. There is nothing to do for a planned cell.
  StepResult reach(CellId c);
  /// Calls visit(CellId) for the neighbours of a planned cell, or of one of the store that has been reached,
  /// but for those of the store that the move replaces.
  template <class Visit>
  void for_each_neighbor(CellId c, Visit&& visit) const {
    for (const FacetId mirror : move_.cell(c).mirrors) {
      if (mirror == kNoFacet) continue;
      const CellId neighbor = cell_of(mirror);
      if (VertexMove::is_planned(neighbor) || !mesh_.is_marked(neighbor)) visit(neighbor);
    }
  }
  /// What the plan replaces; of a move the first num_in_ball() have the vertex.
  std::span<const CellId> region_cells() const { return region_.cells; }
  std::size_t num_in_ball() const { return num_in_ball_; }

  std::size_t num_planned_removals() const { return region_.removed.size(); }

  /// Carries the plan out; created() then lists the new cells.
  /// kTooNear: a vertex that stays lies nearer to p than `min_distance` (mm), or the region has more
  /// vertices than HoleFiller numbers; nothing was written, roll back.
  StepResult commit_insertion(const Point& p, VertexKind kind, double min_distance);
  /// Carries out the move that was planned last; inserted() is the vertex then.
  void commit_move();
  /// The same of a plan that has removals alone.
  StepResult commit_removals();
  /// Gives the plan up; nothing was written. Locks are kept until release().
  void rollback();

  /// The vertex that the last committed insertion made.
  VertexId inserted() const { return inserted_; }
  /// What the last commit made and took away.
  const std::vector<CellId>& created() const { return region_.created; }
  const std::vector<VertexId>& removed() const { return removed_; }
  /// The worker counts here too.
  Counters& counters() { return counters_; }
  const Counters& counters() const { return counters_; }
  /// Cells made less cells taken away, by all commits.
  std::int64_t net_cells() const { return net_cells_; }

 private:
  StepResult lock_cell(CellId c);
  StepResult lock_beyond(FacetId facet);
  StepResult lock(VertexId v);
  bool is_known(CellId c) const;
  bool may_read(CellId c) const;
  void begin_around(const Point& p);
  bool may_replace(CellId c) const;
  void count(AccessKind kind, CellId c) {
    if (counts()) [[unlikely]]
      tally_->add(kind, mesh_.node_of_cell(c), mesh_.address(c));
  }
  void count_vertex(AccessKind kind, VertexId v) {
    if (counts()) [[unlikely]]
      tally_->add(kind, mesh_.node_of_vertex(v), &mesh_.vertex(v));
  }
  bool counts() const { return Locks::kIsShared && tally_ != nullptr; }
  void count_gluing();
  void count_filling();
  void add_to_region(CellId c);
  bool is_in_conflict(CellId c, const Point& p);
  void collect_boundary();
  StepResult dig(CellId c, const Point& p);
  StepResult dig_beyond(FacetId facet, const Point& p);
  double squared_distance_to_region(const Point& p) const;
  void reserve_memory(std::size_t num_created);
  void finish(std::size_t num_destroyed);

  Mesh& mesh_;
  Pool& pool_;
  Locks locks_;
  Region region_;
  std::vector<CellId> ball_;  // scratch of plan_removal
  StarFiller star_;
  HoleFiller hole_;
  VertexMove move_;
  std::size_t num_in_ball_ = 0;  // of the region's cells, where a move is planned
  std::vector<CellId> cavity_;   // scratch of plan_move_to: planned cells, and some of the store
  bool is_cavity_ = false;       // the region is one point's cavity, its boundary collected while digging
  VertexId inserted_ = kNoVertex;
  std::vector<VertexId> removed_;
  Counters counters_;
  std::int64_t net_cells_ = 0;
  AccessTally* tally_;
};

extern template class Operation<NoLocks>;
extern template class Operation<VertexLocks>;

}  // namespace podm
