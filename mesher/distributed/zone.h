// What a rank may change in a round, and what it knows: vertices of the cubes of its zone, and the cells
// whose balls lie in cubes of which it has all vertices.
//
// Ranks lock nothing against each other. Zones of one round have no cube in common, an operation replaces
// only cells whose four vertices are in its zone, and a cell that it looks at has a vertex there. That is the
// proof of octree/leaf_region.h, if each rank's copy of what its operations look at is right:
//   A store holds the Delaunay triangulation of what vertices it knows. A cell whose ball lies in known cubes
//   has no vertex of the whole triangulation in its ball, and its own four are vertices of the whole, so it
//   is a cell of the whole: by the symbolic perturbation, which goes by coordinates
//   (geometry/predicates.cpp), there is but one. What is looked at and is not such a cell ends the operation,
//   and waits for another round. Meanwhile others change the whole. None of their operations replaces a cell
//   with a vertex in our zone; those that we look at have one. So they stay cells of the whole until we
//   replace them, and what we make of cells of the whole are cells of the whole.
// The inserted vertex has to lie in the zone too, so that a cube's vertices have one writer a round.
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
  /// `known` holds all cubes within `rings` of own ones. Insertions are begun only where the ball around the
  /// point of `room_over_radius` times the radius of the cell to go lies in the zone.
  Zone(CubeSet own, CubeSet known, int rings, double room_over_radius = 0);

  bool has(const Point& p) const { return own_.has(p); }
  /// All that is nearer to p than the root of this lies in the zone, mm^2.
  float squared_reach(const Point& p) const { return squared_reach_[own_depth_[own_.grid().cube_at(p)]]; }
  /// Whether the two vertices that readers lock lie in the zone: so each neighbour has a vertex there.
  bool may_read(const Mesh& mesh, const Cell& cell) const {
    return cell.squared_radius < squared_reach(cell.center) ||
           (has(mesh.point(cell.vertices[0])) && has(mesh.point(cell.vertices[3])));
  }
  /// Whether a vertex is to be inserted at p, in the cell's ball.
  bool has_room(const Point& p, const Cell& cell) const {
    if (!has(p)) return false;
    if (squared_room_ == 0 || std::isnan(cell.squared_radius)) return true;
    const double squared_radius = squared_room_ * static_cast<double>(cell.squared_radius);
    return squared_radius < squared_reach(p) || own_.covers(p, std::sqrt(squared_radius));
  }
  /// Of a cell with a vertex in the zone.
  bool knows(const Cell& cell) const {
    return cell.squared_radius <= sure_squared_radius_ || is_ball_known(cell);
  }
  /// Of a neighbour of a cell with a vertex in the zone.
  bool knows_beside(const Cell& cell, const Cell& neighbor) const {
    return (cell.squared_radius <= sure_squared_radius_ / 4 &&
            neighbor.squared_radius <= sure_squared_radius_ / 4) ||
           is_ball_known(neighbor);
  }
  /// Of any cell.
  bool is_ball_known(const Cell& cell) const;
  /// Makes it so, if these become known.
  static void insert_ball(const Cell& cell, CubeSet& cubes);
  bool is_ball_known(const Point& center, double radius_mm) const;

 private:
  static constexpr std::uint8_t kMostDepth = 31;
  CubeSet own_, known_;
  std::vector<std::uint8_t> own_depth_, known_depth_;  // by cube: how deep it lies in these
  std::array<float, kMostDepth + 1> squared_reach_{};  // mm^2, by depth
  double squared_room_;
  bool is_all_known_;
  CubeCounts known_counts_;
  float sure_squared_radius_;  // mm^2: balls no larger are known
};

/// Locks of workers in a zone: `Inner`, with the zone as the operations' horizon. Deep in the zone one look
/// at a cell's radius says that it is all there.
template <class Inner>
class ZoneLocks {
 public:
  static constexpr bool kIsShared = Inner::kIsShared;
  explicit ZoneLocks(WorkerId self) : inner_(self) {}

  /// Nothing is held meanwhile. The zone must outlive the operations.
  void confine(const Zone& zone) { zone_ = &zone; }

  StepResult try_lock(Vertex& v) { return inner_.try_lock(v); }
  bool holds(const Vertex& v) const { return inner_.holds(v); }
  /// What the lock contract counts as held for a change: ranks do not lock against each other.
  bool may_change(const Vertex& v) const { return zone_->has(peek_point(v)) && holds(v); }
  void unlock_all() { inner_.unlock_all(); }
  WorkerId conflicting_worker() const { return inner_.conflicting_worker(); }

  bool knows(const Cell& cell) const { return zone_->knows(cell); }
  bool may_read(const Mesh& mesh, const Cell& cell) const { return zone_->may_read(mesh, cell); }
  // Two points of a ball are no farther from each other than twice its radius.
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
  float squared_reach_ = 0;  // mm^2: balls no larger with the operation's point in them lie in the zone
};

extern template class Operation<ZoneLocks<NoLocks>>;
extern template class Operation<ZoneLocks<VertexLocks>>;
extern template class Worker<ZoneLocks<NoLocks>>;
extern template class Worker<ZoneLocks<VertexLocks>>;

}  // namespace podm
