// One operation on the triangulation: the insertion of a vertex, together with the removal of others.
//
// An operation is cautious. *Reserving* locks two vertices of the cell that requests the operation; two are
// enough to read it. *Planning* reads, locks and collects the region: the cells that will die. For an
// insertion these are the cells in conflict with the point (the cavity), for a removal the cells around the
// vertex (its ball); an isosurface insertion with its R6 removals takes their union. *Committing* replaces
// the region by new Delaunay cells. A plan that cannot be carried out is rolled back, with nothing written.
// *Releasing* unlocks all. Memory is allocated before the first write, so std::bad_alloc from any step leaves
// a plan that can be rolled back.
//
// One region serves all operations for this reason: a cell of the old triangulation stays Delaunay unless it
// has a removed vertex or conflicts with the new one. Therefore the region's boundary facets are facets of
// the new triangulation too.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "delaunay/hole.h"
#include "delaunay/mesh.h"
#include "delaunay/pool.h"
#include "delaunay/star.h"
#include "delaunay/vertex_locks.h"
#include "delaunay/vertex_move.h"
#include "podm/counters.h"

namespace podm {

/// Locks of a worker whose store may differ from the whole triangulation beyond a horizon
/// (distributed/zone.h). They decide which cells belong to the whole triangulation, which cells may be read
/// and replaced by an operation around a point in their balls, and where in a cell's ball a vertex may be
/// inserted.
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
  /// that are not shared count none: such a run is on one node.
  Operation(Mesh& mesh, Pool& pool, WorkerId self, AccessTally* tally = nullptr)
      : mesh_(mesh), pool_(pool), locks_(self), move_(mesh), tally_(tally) {}

  /// Locks two vertices of the cell c with that stamp, after which it and its neighbours may be read.
  /// kStaleCell: the cell has died. kLockConflict: conflicting_worker() holds a vertex. kOutOfReach: the cell
  /// or a neighbour is beyond the horizon. Holds no lock unless it returns kDone.
  StepResult reserve(CellId c, std::uint32_t stamp);
  void release() {
    forget_reads();
    locks_.unlock_all();
  }
  Locks& locks() { return locks_; }
  WorkerId conflicting_worker() const { return locks_.conflicting_worker(); }

  /// Digs the cavity of p from `start`, a cell in conflict with p that is reserved or next to a reserved
  /// cell. kNotInConflict: `start` is not in conflict. The caller must roll back unless the result is kDone.
  /// plan_removal() may extend the plan.
  StepResult plan_insertion(const Point& p, CellId start);
  /// Adds the ball of v, a vertex of the cell `seed`, to the region.
  StepResult plan_removal(VertexId v, CellId seed);
  /// Calls visit(VertexId, CellId) for the vertices of every cell of the region, for some more than once.
  /// `visit` may extend the plan; the added cells are visited too.
  template <class Visit>
  void for_each_region_vertex(Visit&& visit) const {
    for (std::size_t i = 0; i < region_.cells.size(); ++i) {
      const std::array<VertexId, 4> vertices = mesh_.cell(region_.cells[i]).vertices;
      for (const VertexId v : vertices) visit(v, region_.cells[i]);
    }
  }
  /// Calls visit(VertexId) for the vertices of the region whose squared distance from p, the point of the
  /// last planned insertion, is below `squared_reach`, mm^2. A vertex farther away may be visited too, and
  /// some are visited more than once, if the region is no cavity or has very many vertices.
  template <class Visit>
  void for_each_region_vertex_near(double squared_reach, Visit&& visit) const {
    if (is_star_) {
      star_.for_each_vertex_within(squared_reach, visit);
    } else {
      for_each_region_vertex([&](VertexId v, CellId) { visit(v); });
    }
  }
  bool removes(VertexId v) const;
  /// True if a facet between the cavity that was planned last and other cells has this edge. The edge then
  /// stays when the vertex is inserted.
  bool keeps_edge(VertexId u, VertexId v) const;
  /// Locks all vertices of c, a cell that may be read. The fault to be planted leaves it at the two that are
  /// held.
  StepResult hold(CellId c) { return locks_taken().to_look_up == 4 ? lock_cell(c) : StepResult::kDone; }

  /// Plans the move of v, a vertex of the cell `seed`, to places that are given later. v's ball becomes the
  /// region. kTooNear: the ball has too many vertices. The caller must roll back unless the result is kDone.
  StepResult plan_move(VertexId v, CellId seed);
  /// Plans the move to p in place of any earlier p; move() has the cells. p must be nearer to the vertex's
  /// present place than to all other vertices. The caller must roll back unless the result is kDone; after
  /// kNotInConflict it may try another point instead.
  StepResult plan_move_to(const Point& p);
  VertexMove& move() { return move_; }
  /// Locks two vertices of c, which may be read already; afterwards its neighbours may be read too.
  /// kOutOfReach: one of these cells is beyond the horizon. Does nothing for a planned cell.
  StepResult reach(CellId c);
  /// Calls visit(CellId) for the neighbours of a planned cell or of a stored cell that has been reached,
  /// except for stored cells that the move replaces.
  template <class Visit>
  void for_each_neighbor(CellId c, Visit&& visit) const {
    for (const FacetId mirror : move_.cell(c).mirrors) {
      if (mirror == kNoFacet) continue;
      const CellId neighbor = cell_of(mirror);
      if (VertexMove::is_planned(neighbor) || !mesh_.is_marked(neighbor)) visit(neighbor);
    }
  }
  /// The cells that the plan replaces. For a move, the first num_in_ball() of them have the vertex.
  std::span<const CellId> region_cells() const { return region_.cells; }
  std::size_t num_in_ball() const { return num_in_ball_; }

  std::size_t num_planned_removals() const { return region_.removed.size(); }

  /// Carries the plan out; created() then lists the new cells. kTooNear: a vertex that stays is nearer to p
  /// than `min_distance` (mm), or the region has more vertices than HoleFiller can number. Nothing was
  /// written then, and the caller must roll back.
  StepResult commit_insertion(const Point& p, VertexKind kind, double min_distance, SideMask sides = 0);
  /// Carries out the move that was planned last; inserted() is then the vertex.
  void commit_move();
  /// Carries out a plan that consists of removals only; kTooNear: the region has too many vertices.
  StepResult commit_removals();
  /// Gives up the plan; nothing was written. Locks are held until release().
  void rollback();

  /// The vertex that the last committed insertion made.
  VertexId inserted() const { return inserted_; }
  /// The cells that the last commit made and the vertices that it removed.
  const std::vector<CellId>& created() const { return region_.created; }
  const std::vector<VertexId>& removed() const { return removed_; }
  /// The worker adds its own counts here.
  Counters& counters() { return counters_; }
  const Counters& counters() const { return counters_; }
  SharedRequests shared_requests() const { return pool_.requests(); }
  /// The number of cells made minus the number of cells removed, over all commits.
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
  bool knows_beyond_boundary() const;
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
  std::size_t num_in_ball_ = 0;  // cells of the region around the vertex of a planned move
  std::vector<CellId> cavity_;   // scratch of plan_move_to: planned and stored cells
  bool is_cavity_ = false;       // the region is one point's cavity; its boundary was collected while digging
  bool is_star_ = false;         // star_ is prepared to fill the cavity
  VertexId inserted_ = kNoVertex;
  std::vector<VertexId> removed_;
  Counters counters_;
  std::int64_t net_cells_ = 0;
  AccessTally* tally_;
};

extern template class Operation<NoLocks>;
extern template class Operation<VertexLocks>;

}  // namespace podm
