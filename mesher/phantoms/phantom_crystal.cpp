#include "phantoms/phantom_crystal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace podm {

namespace {

constexpr std::uint32_t kGrains = 40;

// The sites are spread evenly by an additive recurrence with irrational steps, after M. Roberts: the powers
// of 1 / g, where g^4 = g + 1.
Point site(std::uint32_t grain) {
  constexpr double kRoot = 1.22074408460575947536;
  const auto spread = [grain](double step, double half) {
    const double at = 0.5 + step * (grain + 1);
    return (2 * (at - std::floor(at)) - 1) * half;
  };
  return {spread(1 / kRoot, kCrystalHalfExtent.x), spread(1 / (kRoot * kRoot), kCrystalHalfExtent.y),
          spread(1 / (kRoot * kRoot * kRoot), kCrystalHalfExtent.z)};
}

// The other sites, the nearest first.
std::vector<Point> sites_around(std::uint32_t grain) {
  std::vector<Point> sites;
  for (std::uint32_t i = 0; i < kGrains; ++i)
    if (i != grain) sites.push_back(site(i));
  std::ranges::sort(sites, {}, [own = site(grain)](const Point& p) { return squared_distance(p, own); });
  return sites;
}

Shape shape_of(std::uint32_t grain) {
  const auto value = [own = site(grain), others = sites_around(grain)](const Point& p) {
    const double distance = squared_distance(p, own);
    const bool is_inside = std::ranges::all_of(
        others, [&](const Point& other) { return distance < squared_distance(p, other); });
    return is_inside ? -1.0 : 1.0;
  };
  return {value, -1.1 * kCrystalHalfExtent, 1.1 * kCrystalHalfExtent};
}

}  // namespace

std::vector<Organ> crystal_grains() {
  std::vector<Organ> grains;
  for (std::uint32_t grain = 0; grain < kGrains; ++grain)
    grains.push_back({grain + 1, fmt::format("grain {}", grain + 1), shape_of(grain)});
  return grains;
}

}  // namespace podm
