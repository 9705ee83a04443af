#include "claims/circumsphere.h"

#include <cmath>

#include "geometry/circumcenter.h"

namespace podm::verify {

namespace {

constexpr double kError = 1e-9;

bool is_finite(const Circumsphere& sphere) {
  return std::isfinite(sphere.radius + sphere.voxel[0] + sphere.voxel[1] + sphere.voxel[2]);
}

// Returns nothing if intervals are too wide.
std::optional<Circumsphere> from_intervals(const CellPoints& p, const VoxelMap& to_voxels) {
  const CGAL::Protect_FPU_rounding<true> rounding_upwards;
  const auto center = circumcenter<Interval>(p);
  const Fraction<Interval> r2 = squared_circumradius<Interval>(p);
  if (!center || !(low(r2.denominator) > 0)) return std::nullopt;
  const Interval squared = r2.numerator / r2.denominator;
  if (!(high(squared) - low(squared) <= kError * low(squared))) return std::nullopt;
  Circumsphere sphere{.voxel = {}, .radius = std::sqrt(CGAL::to_double(squared))};
  const Vector<Interval> voxel = to_voxels(*center);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(high(voxel[i]) - low(voxel[i]) <= kError)) return std::nullopt;
    sphere.voxel[i] = CGAL::to_double(voxel[i]);
  }
  return sphere;
}

}  // namespace

std::optional<Circumsphere> circumsphere(const CellPoints& p, const VoxelMap& to_voxels) {
  std::optional<Circumsphere> sphere = from_intervals(p, to_voxels);
  if (!sphere) {
    const auto center = circumcenter<Rational>(p);
    if (!center) return std::nullopt;
    const Fraction<Rational> r2 = squared_circumradius<Rational>(p);
    sphere.emplace(
        Circumsphere{.voxel = {}, .radius = std::sqrt(CGAL::to_double(r2.numerator / r2.denominator))});
    const Vector<Rational> voxel = to_voxels(*center);
    for (std::size_t i = 0; i < 3; ++i) sphere->voxel[i] = CGAL::to_double(voxel[i]);
  }
  return is_finite(*sphere) ? sphere : std::nullopt;
}

}  // namespace podm::verify
