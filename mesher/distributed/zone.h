// The part of space in which a rank may change the mesh in a round, and the part that it knows. A zone
// consists of the vertices in its cubes. A rank knows the cells whose balls lie in cubes of which it has all
// vertices.
//
// Ranks do not lock against each other. Zones of one round have no cube in common. An operation replaces only
// cells whose four vertices are in its zone. A cell that it reads has a vertex there. With these facts the
// proof of octree/leaf_region.h applies, provided that each rank's copy of what its operations read is
// correct:
//   A store holds the Delaunay triangulation of the vertices that it knows. A cell whose ball lies in known
//   cubes has no vertex of the whole triangulation in its ball, and its own four vertices are vertices of
//   the whole. It is therefore a cell of the whole: with the symbolic perturbation, which depends on
//   coordinates (geometry/predicates.cpp), the triangulation is unique. An operation that reads any other
//   cell ends, and its cell waits for another round. Meanwhile other ranks change the whole. None of their
//   operations replaces a cell with a vertex in our zone, and the cells that we read have such a vertex.
//   These cells therefore stay cells of the whole until we replace them, and the cells that we make from
//   cells of the whole are cells of the whole.
// The inserted vertex must lie in the zone, too, so that a cube's vertices have one writer per round.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "delaunay/operation.h"
#include "delaunay/planted_fault.h"

#include "distributed/cubes.h"
#include "refine/worker.h"

namespace podm {

class Zone {
 public:
  /// `known` holds all cubes within `rings` of own cubes. An insertion starts only if a ball around its point
  /// lies in the zone. The radius of this ball is `room_over_radius` times the radius of the cell to be
  /// removed.
  Zone(CubeSet own, CubeSet known, int rings, double room_over_radius = 0);

  bool has(const Point& p) const { return own_.has(p); }
  /// Returns a squared distance, mm^2: all points nearer to p than its root lie in the zone.
  float squared_reach(const Point& p) const { return squared_reach_[own_depth_(own_.grid().place_of(p))]; }
  /// Returns true if the two vertices that readers lock lie in the zone. Each neighbour then has a vertex
  /// there.
  bool may_read(const Mesh& mesh, const Cell& cell) const {
    return cell.squared_radius < squared_reach(cell.center) ||
           (has(mesh.point(cell.vertices[0])) && has(mesh.point(cell.vertices[3])));
  }
  /// Returns true if a vertex may be inserted at p, in the cell's ball.
  bool has_room(const Point& p, const Cell& cell) const {
    if (!has(p)) return false;
    if (squared_room_ == 0 || std::isnan(cell.squared_radius)) return true;
    const double squared_radius = squared_room_ * static_cast<double>(cell.squared_radius);
    return squared_radius < squared_reach(p) || own_.covers(p, std::sqrt(squared_radius));
  }
  /// Returns true if the cell is known to be a cell of the whole. The cell must have a vertex in the zone.
  bool knows(const Cell& cell) const {
    return cell.squared_radius <= sure_squared_radius_ || is_ball_known(cell);
  }
  /// Returns true if `neighbor` is known. It must be a neighbour of `cell`, which has a vertex in the zone.
  bool knows_beside(const Cell& cell, const Cell& neighbor) const {
    return (cell.squared_radius <= sure_squared_radius_ / 4 &&
            neighbor.squared_radius <= sure_squared_radius_ / 4) ||
           is_ball_known(neighbor);
  }
  /// Returns true if the ball of the cell is known. The cell may be anywhere.
  bool is_ball_known(const Cell& cell) const;
  /// Adds the cubes that must be known for is_ball_known(cell).
  static void insert_ball(const Cell& cell, CubeSet& cubes);
  bool is_ball_known(const Point& center, double radius_mm) const;

 private:
  static constexpr std::uint8_t kMostDepth = 31;
  // Rings of cubes around the zone whose depths among the known cubes are tabulated. Most centers lie there.
  static constexpr int kRingsOfDepths = 4;
  CubeSet own_, known_;
  CubeDepths own_depth_, known_depth_;
  std::array<float, kMostDepth + 1> squared_reach_{};  // mm^2, by depth
  double squared_room_;
  bool is_all_known_;
  float sure_squared_radius_;  // mm^2: all balls up to this size are known
};

/// Locks of workers in a zone: `Inner`, with the zone as the limit of the operations. Deep in the zone the
/// radius of a cell alone proves that the cell is inside.
template <class Inner>
class ZoneLocks {
 public:
  static constexpr bool kIsShared = Inner::kIsShared;
  explicit ZoneLocks(WorkerId self) : inner_(self) {}

  /// Sets the zone. The worker must hold no lock. The zone must outlive the operations.
  void confine(const Zone& zone) { zone_ = &zone; }

  StepResult try_lock(Vertex& v) { return inner_.try_lock(v); }
  bool holds(const Vertex& v) const { return inner_.holds(v); }
  /// Returns true if the lock contract allows a change of the vertex. Ranks do not lock against each other.
  bool may_change(const Vertex& v) const { return zone_->has(peek_point(v)) && holds(v); }
  void unlock_all() { inner_.unlock_all(); }
  WorkerId conflicting_worker() const { return inner_.conflicting_worker(); }

  bool knows(const Cell& cell) const { return zone_->knows(cell); }
  bool may_read(const Mesh& mesh, const Cell& cell) const { return zone_->may_read(mesh, cell); }
  // Two points of a ball are at most twice its radius apart.
  void begin_around(const Point& p) { squared_reach_ = zone_->squared_reach(p) / 4; }
  bool may_replace(const Mesh& mesh, const Cell& cell) const {
    const auto vertices = std::span(cell.vertices).first(locks_taken().in_zone);
    return cell.squared_radius < squared_reach_ ||
           std::all_of(vertices.begin(), vertices.end(), [&](VertexId v) { return has(mesh, v); });
  }
  bool may_insert(const Point& p, const Cell& cell) const { return zone_->has_room(p, cell); }

 private:
  bool has(const Mesh& mesh, VertexId v) const { return zone_->has(mesh.point(v)); }

  Inner inner_;
  const Zone* zone_ = nullptr;
  // Mm^2: all balls up to this size that contain the operation's point lie in the zone.
  float squared_reach_ = 0;
};

extern template class Operation<ZoneLocks<NoLocks>>;
extern template class Operation<ZoneLocks<VertexLocks>>;
extern template class Worker<ZoneLocks<NoLocks>>;
extern template class Worker<ZoneLocks<VertexLocks>>;

}  // namespace podm
