// The definitions of Operation's members, for code that defines its own locks: one of its sources includes
// this file and instantiates Operation for these locks. All other code includes operation.h.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "delaunay/lock_to_read.h"
#include "delaunay/operation.h"
#include "delaunay/planted_fault.h"

namespace podm {

template <class Locks>
StepResult Operation<Locks>::reserve(CellId c, std::uint32_t stamp) {
  StepResult result = lock_to_read<Locks>(mesh_, c, stamp, [this](VertexId v) { return lock(v); });
  if (result == StepResult::kDone && !may_read(c)) result = StepResult::kOutOfReach;
  if (result != StepResult::kDone) locks_.unlock_all();
  return result;
}

template <class Locks>
inline bool Operation<Locks>::is_known([[maybe_unused]] CellId c) const {
  if constexpr (HasHorizon<Locks>) {
    return locks_.knows(mesh_.cell(c));
  } else {
    return true;
  }
}

template <class Locks>
inline bool Operation<Locks>::may_read([[maybe_unused]] CellId c) const {
  if constexpr (HasHorizon<Locks>) {
    const Cell& cell = mesh_.cell(c);
    if (!locks_.may_read(mesh_, cell) || !locks_.knows(cell)) return false;
    for (const FacetId mirror : cell.mirrors)
      if (mirror != kNoFacet && !is_known(cell_of(mirror))) return false;
  }
  return true;
}

template <class Locks>
inline void Operation<Locks>::begin_around([[maybe_unused]] const Point& p) {
  if constexpr (HasHorizon<Locks>) locks_.begin_around(p);
}

// Precondition: the point that the operation is around lies in the cell's ball.
template <class Locks>
inline bool Operation<Locks>::may_replace([[maybe_unused]] CellId c) const {
  if constexpr (HasHorizon<Locks>) {
    return locks_.may_replace(mesh_, mesh_.cell(c));
  } else {
    return true;
  }
}

template <class Locks>
inline StepResult Operation<Locks>::lock(VertexId v) {
  count_vertex(AccessKind::kMeshRead, v);
  return locks_.try_lock(mesh_.vertex(v));
}

template <class Locks>
StepResult Operation<Locks>::lock_cell(CellId c) {
  if (!may_replace(c)) return StepResult::kOutOfReach;
  for (const VertexId v : mesh_.cell(c).vertices) {
    if (const StepResult locked = lock(v); locked != StepResult::kDone) return locked;
  }
  return StepResult::kDone;
}

// Locks the cell that `facet` belongs to; the facet's own vertices are already held. If no lock on the other
// vertex is needed, prefetches the vertex, because filling the hole will read it.
template <class Locks>
StepResult Operation<Locks>::lock_beyond(FacetId facet) {
  if (!may_replace(cell_of(facet))) return StepResult::kOutOfReach;
  const auto& vertices = mesh_.cell(cell_of(facet)).vertices;
  const VertexId apex = vertices[static_cast<unsigned>(index_in_cell(facet))];
  if (Locks::kIsShared && locks_taken().to_replace == 4) return lock(apex);
  mesh_.prefetch_vertex(apex);
  return StepResult::kDone;
}

template <class Locks>
void Operation<Locks>::add_to_region(CellId c) {
  region_.cells.push_back(c);
  mesh_.mark(c, true);
  ++counters_.region_cells;
  for (const FacetId mirror : mesh_.cell(c).mirrors) {
    if (mirror != kNoFacet) mesh_.prefetch(cell_of(mirror));  // read when the front reaches c
  }
}

template <class Locks>
inline bool Operation<Locks>::is_in_conflict(CellId c, const Point& p) {
  ++counters_.conflict_tests;
  count(AccessKind::kMeshRead, c);
  const Cell& cell = mesh_.cell(c);
  const Side side = side_of(cell.center, cell.squared_radius, p);
  if (side != Side::kUndecided) return side == Side::kInside;
  ++counters_.exact_decisions;
  return mesh_.is_in_conflict(c, p);
}

template <class Locks>
StepResult Operation<Locks>::plan_insertion(const Point& p, CellId start) {
  is_cavity_ = true;
  is_star_ = false;
  if constexpr (HasHorizon<Locks>) {
    if (!locks_.may_insert(p, mesh_.cell(start))) return StepResult::kOutOfReach;
  }
  begin_around(p);
  if (!is_in_conflict(start, p)) return StepResult::kNotInConflict;
  if (const StepResult locked = lock_cell(start); locked != StepResult::kDone) return locked;
  add_to_region(start);
  for (std::size_t i = 0; i < region_.cells.size(); ++i) {
    const CellId c = region_.cells[i];
    const std::array<FacetId, 4> mirrors = mesh_.cell(c).mirrors;
    for (unsigned k = 0; k < 4; ++k) {
      if (mirrors[k] == kNoFacet) {
        region_.boundary.push_back(4 * c + k);
        continue;
      }
      const CellId neighbor = cell_of(mirrors[k]);
      if (mesh_.is_marked(neighbor)) continue;
      if (!is_known(neighbor)) return StepResult::kOutOfReach;
      if (is_in_conflict(neighbor, p)) {
        if (const StepResult locked = lock_beyond(mirrors[k]); locked != StepResult::kDone) return locked;
        add_to_region(neighbor);
      } else {
        region_.boundary.push_back(4 * c + k);
      }
    }
  }
  is_star_ = star_.prepare(mesh_, region_, p);
  return StepResult::kDone;
}

template <class Locks>
StepResult Operation<Locks>::plan_removal(VertexId v, CellId seed) {
  is_cavity_ = is_star_ = false;
  region_.removed.push_back(v);
  begin_around(mesh_.point(v));
  // The walk passes through cells around v that are already in the region, so it keeps its own list.
  ball_.assign(1, seed);
  if (const StepResult locked = lock_cell(seed); locked != StepResult::kDone) return locked;
  if (!mesh_.is_marked(seed)) add_to_region(seed);
  for (std::size_t i = 0; i < ball_.size(); ++i) {
    const Cell& cell = mesh_.cell(ball_[i]);
    for (unsigned k = 0; k < 4; ++k) {
      if (cell.vertices[k] == v || cell.mirrors[k] == kNoFacet) continue;
      const CellId neighbor = cell_of(cell.mirrors[k]);
      if (std::find(ball_.begin(), ball_.end(), neighbor) != ball_.end()) continue;
      if (!is_known(neighbor)) return StepResult::kOutOfReach;
      if (const StepResult locked = lock_beyond(cell.mirrors[k]); locked != StepResult::kDone) return locked;
      if (!mesh_.is_marked(neighbor)) add_to_region(neighbor);
      ball_.push_back(neighbor);
    }
  }
  return StepResult::kDone;
}

template <class Locks>
StepResult Operation<Locks>::plan_move(VertexId v, CellId seed) {
  if (mesh_.cell_bound() > VertexMove::kFirstPlanned) return StepResult::kTooNear;
  if (const StepResult planned = plan_removal(v, seed); planned != StepResult::kDone) return planned;
  num_in_ball_ = region_.cells.size();
  collect_boundary();
  if (!knows_beyond_boundary()) return StepResult::kOutOfReach;
  if (!hole_.plan(mesh_, region_, nullptr) || !VertexMove::has_ids_for(hole_.num_cells()))
    return StepResult::kTooNear;
  move_.begin(v, hole_);
  counters_.planned_cells += hole_.num_cells();
  return StepResult::kDone;
}

template <class Locks>
StepResult Operation<Locks>::plan_move_to(const Point& p) {
  for (; region_.cells.size() > num_in_ball_; region_.cells.pop_back())
    mesh_.mark(region_.cells.back(), false);
  if constexpr (HasHorizon<Locks>) {
    if (!locks_.may_insert(p, mesh_.cell(region_.cells.front()))) return StepResult::kOutOfReach;
  }
  begin_around(p);
  move_.begin_at(p);
  cavity_.clear();
  region_.boundary.clear();
  for (CellId c = VertexMove::kFirstPlanned; c < move_.first_of_star() && cavity_.empty(); ++c) dig(c, p);
  if (cavity_.empty()) return StepResult::kNotInConflict;
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId facet = 4 * cavity_[i] + k, mirror = move_.mirror(facet);
      const StepResult dug = mirror == kNoFacet                        ? StepResult::kNotInConflict
                             : VertexMove::is_planned(cell_of(mirror)) ? dig(cell_of(mirror), p)
                                                                       : dig_beyond(mirror, p);
      if (dug == StepResult::kNotInConflict) {
        region_.boundary.push_back(facet);
      } else if (dug != StepResult::kDone) {
        return dug;
      }
    }
  }
  if (!VertexMove::has_ids_for(hole_.num_cells() + region_.boundary.size()))
    return StepResult::kNotInConflict;
  for (const FacetId facet : region_.boundary) move_.add_star_facet(facet);
  counters_.planned_cells += region_.boundary.size();
  return StepResult::kDone;
}

template <class Locks>
StepResult Operation<Locks>::reach(CellId c) {
  if (VertexMove::is_planned(c)) return StepResult::kDone;
  const std::array<VertexId, 4> vertices = mesh_.cell(c).vertices;
  for (const VertexId v : std::span(vertices).first(locks_taken().to_read))
    if (const StepResult locked = lock(v); locked != StepResult::kDone) return locked;
  return may_read(c) ? StepResult::kDone : StepResult::kOutOfReach;
}

// Puts a planned cell into the cavity if it is in conflict.
template <class Locks>
StepResult Operation<Locks>::dig(CellId c, const Point& p) {
  if (move_.is_dug(c)) return StepResult::kDone;
  ++counters_.conflict_tests;
  if (!move_.is_in_conflict(c, p)) return StepResult::kNotInConflict;
  move_.dig(c);
  cavity_.push_back(c);
  return StepResult::kDone;
}

// Puts a stored cell beyond the hole, to which the facet belongs, into the cavity if it is in conflict.
template <class Locks>
StepResult Operation<Locks>::dig_beyond(FacetId facet, const Point& p) {
  const CellId c = cell_of(facet);
  if (mesh_.is_marked(c)) return StepResult::kDone;
  if (!is_known(c)) return StepResult::kOutOfReach;
  if (!is_in_conflict(c, p)) return StepResult::kNotInConflict;
  if (locks_taken().to_move == 4) {
    if (const StepResult locked = lock_beyond(facet); locked != StepResult::kDone) return locked;
  }
  add_to_region(c);
  cavity_.push_back(c);
  return StepResult::kDone;
}

template <class Locks>
bool Operation<Locks>::removes(VertexId v) const {
  return std::find(region_.removed.begin(), region_.removed.end(), v) != region_.removed.end();
}

template <class Locks>
bool Operation<Locks>::keeps_edge(VertexId u, VertexId v) const {
  return std::any_of(region_.boundary.begin(), region_.boundary.end(), [&](FacetId facet) {
    const Cell& cell = mesh_.cell(cell_of(facet));
    const VertexId opposite = cell.vertices[static_cast<unsigned>(index_in_cell(facet))];
    return u != opposite && v != opposite && cell.has(u) && cell.has(v);
  });
}

template <class Locks>
void Operation<Locks>::collect_boundary() {
  region_.boundary.clear();
  for (const CellId c : region_.cells) {
    for (unsigned k = 0; k < 4; ++k) {
      const FacetId mirror = mesh_.cell(c).mirrors[k];
      if (mirror == kNoFacet || !mesh_.is_marked(cell_of(mirror))) region_.boundary.push_back(4 * c + k);
    }
  }
}

// Each of these cells shares a facet with the region, and therefore has vertices within the horizon.
template <class Locks>
bool Operation<Locks>::knows_beyond_boundary() const {
  if constexpr (HasHorizon<Locks>) {
    return std::all_of(region_.boundary.begin(), region_.boundary.end(), [&](FacetId facet) {
      const FacetId mirror = mesh_.cell(cell_of(facet)).mirrors[static_cast<unsigned>(index_in_cell(facet))];
      return mirror == kNoFacet || is_known(cell_of(mirror));
    });
  } else {
    return true;
  }
}

template <class Locks>
double Operation<Locks>::squared_distance_to_region(const Point& p) const {
  double nearest = std::numeric_limits<double>::infinity();
  for_each_region_vertex([&](VertexId v, CellId) {
    if (!removes(v)) nearest = std::min(nearest, squared_distance(mesh_.point(v), p));
  });
  return nearest;
}

// Reserves all memory that the commit writes to: nothing after this throws.
template <class Locks>
void Operation<Locks>::reserve_memory(std::size_t num_created) {
  region_.created.reserve(num_created);
  pool_.reserve(region_.cells, num_created, region_.removed.size());
}

template <class Locks>
StepResult Operation<Locks>::commit_insertion(const Point& p, VertexKind kind, double min_distance,
                                              SideMask sides) {
  const double nearest = is_star_ ? star_.squared_distance() : squared_distance_to_region(p);
  if (nearest < min_distance * min_distance) return StepResult::kTooNear;
  if (!is_star_) {
    if (!is_cavity_) collect_boundary();
    if (!hole_.plan(mesh_, region_, &p)) return StepResult::kTooNear;
  }
  reserve_memory(is_star_ ? star_.num_cells() : hole_.num_cells());
  count_gluing();
  inserted_ = pool_.take_vertex();
  place(mesh_.vertex(inserted_), p, kind, sides);  // a worker with a stale entry may try its lock
  const std::size_t num_destroyed = region_.cells.size();
  if (is_star_) {
    star_.fill(mesh_, pool_, region_, inserted_);
  } else {
    hole_.fill(mesh_, pool_, region_, inserted_);
  }
  count_vertex(AccessKind::kMeshWrite, inserted_);
  finish(num_destroyed);
  return StepResult::kDone;
}

template <class Locks>
void Operation<Locks>::commit_move() {
  reserve_memory(move_.num_cells());
  collect_boundary();
  count_gluing();
  inserted_ = pool_.take_vertex();
  place(mesh_.vertex(inserted_), move_.point(), move_.kind(), move_.sides());
  const std::size_t num_destroyed = region_.cells.size();
  move_.fill(pool_, region_, inserted_);
  count_vertex(AccessKind::kMeshWrite, inserted_);
  finish(num_destroyed);
}

template <class Locks>
StepResult Operation<Locks>::commit_removals() {
  collect_boundary();
  if (!hole_.plan(mesh_, region_, nullptr)) return StepResult::kTooNear;
  reserve_memory(hole_.num_cells());
  count_gluing();
  const std::size_t num_destroyed = region_.cells.size();
  hole_.fill(mesh_, pool_, region_, kNoVertex);
  finish(num_destroyed);
  return StepResult::kDone;
}

// Counts the cells beyond the boundary, once per glued facet. Must be called before the filling.
template <class Locks>
void Operation<Locks>::count_gluing() {
  if (!counts()) return;
  for (const FacetId f : region_.boundary) {
    const FacetId mirror = mesh_.cell(cell_of(f)).mirrors[static_cast<unsigned>(index_in_cell(f))];
    if (mirror != kNoFacet) count(AccessKind::kMeshWrite, cell_of(mirror));
  }
}

// Counts the cells made, the slots that stay empty and the vertices removed. Must be called after the
// filling.
template <class Locks>
void Operation<Locks>::count_filling() {
  if (!counts()) return;
  for (const CellId c : region_.created) count(AccessKind::kMeshWrite, c);
  for (const CellId c : region_.cells)
    if (!mesh_.peek_is_alive(c)) count(AccessKind::kMeshWrite, c);
  for (const VertexId v : region_.removed) count_vertex(AccessKind::kMeshWrite, v);
}

template <class Locks>
void Operation<Locks>::finish(std::size_t num_destroyed) {
  count_filling();
  counters_.cells_created += region_.created.size();
  net_cells_ += static_cast<std::int64_t>(region_.created.size()) - static_cast<std::int64_t>(num_destroyed);
  for (const VertexId v : region_.removed) pool_.release_vertex(v);
  removed_.swap(region_.removed);
  region_.clear();
}

template <class Locks>
void Operation<Locks>::rollback() {
  for (const CellId c : region_.cells) mesh_.mark(c, false);
  region_.clear();
  region_.created.clear();
}

}  // namespace podm
