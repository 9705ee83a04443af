#include "distributed/zone.h"

#include <cmath>

#include "delaunay/operation_steps.h"
#include "refine/attempt.h"

namespace podm {

namespace {

double sure_radius_mm(const Cell& cell) {
  return std::sqrt((1 + kStoredSphereTolerance) * static_cast<double>(cell.squared_radius));
}

}  // namespace

// A ball of radius r through a vertex of the zone lies within 2r of the vertex. Stored radii have larger
// errors than centers.
Zone::Zone(CubeSet own, CubeSet known, int rings, double room_over_radius)
    : own_(std::move(own)),
      known_(std::move(known)),
      own_depth_(own_, own_.range(), kMostDepth),
      known_depth_(known_, own_.grid().grown(own_.range(), kRingsOfDepths), kMostDepth),
      squared_room_(room_over_radius * room_over_radius),
      is_all_known_(known_.is_full()) {
  for (std::size_t depth = 0; depth < squared_reach_.size(); ++depth) {
    const double reach_mm = (1 - kStoredSphereTolerance) * static_cast<double>(depth) * own_.grid().side_mm();
    squared_reach_[depth] = static_cast<float>(reach_mm * reach_mm * (1 - kStoredSphereTolerance));
  }
  const double sure_radius_mm = (1 - kStoredSphereTolerance) * rings * known_.grid().side_mm() / 2;
  sure_squared_radius_ = static_cast<float>(sure_radius_mm * sure_radius_mm * (1 - kStoredSphereTolerance));
}

bool Zone::is_ball_known(const Cell& cell) const {
  if (is_all_known_) return true;
  if (cell.squared_radius < squared_reach_[known_depth_(known_.grid().place_of(cell.center))]) return true;
  if (std::isnan(cell.squared_radius)) return false;
  return is_ball_known(cell.center, sure_radius_mm(cell));
}

// A cell without a certified sphere may have a ball of any size.
void Zone::insert_ball(const Cell& cell, CubeSet& cubes) {
  if (!std::isnan(cell.squared_radius)) {
    cubes.insert(cell.center, sure_radius_mm(cell) * (1 + kMargin));
  } else {
    cubes.insert_all();
  }
}

bool Zone::is_ball_known(const Point& center, double radius_mm) const {
  return known_.covers(center, radius_mm * (1 + kMargin));
}

template class Operation<ZoneLocks<NoLocks>>;
template class Operation<ZoneLocks<VertexLocks>>;
template class Worker<ZoneLocks<NoLocks>>;
template class Worker<ZoneLocks<VertexLocks>>;

}  // namespace podm
