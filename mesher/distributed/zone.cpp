#include "distributed/zone.h"

#include <cmath>

#include "delaunay/operation_impl.h"
#include "refine/worker_impl.h"

namespace podm {

namespace {

constexpr double kRounding = 1e-6;  // more than a stored squared radius or a centre is off

}  // namespace

// A ball of radius r through a vertex of the zone lies within 2r of it.
Zone::Zone(CubeSet own, const CubeSet& shared, const CubeSet& known, int rings)
    : own_(std::move(own)), shared_(&shared), known_(known) {
  const double sure_radius_mm = (1 - kRounding) * rings * known.grid().side_mm() / 2;
  sure_squared_radius_ = static_cast<float>(sure_radius_mm * sure_radius_mm * (1 - kRounding));
}

// Of one whose radius is not certified nothing is known.
bool Zone::is_ball_known(const Cell& cell) const {
  if (!known_) return true;
  if (std::isnan(cell.squared_radius)) return false;
  return known_->covers(cell.center, (1 + kRounding) * std::sqrt(static_cast<double>(cell.squared_radius)));
}

template class Operation<ZoneLocks<NoLocks>>;
template class Operation<ZoneLocks<VertexLocks>>;
template class Worker<ZoneLocks<NoLocks>>;
template class Worker<ZoneLocks<VertexLocks>>;

}  // namespace podm
