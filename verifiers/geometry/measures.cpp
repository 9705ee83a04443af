#include "geometry/measures.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace podm::verify {

namespace {

double degrees(double radians) { return radians * (180 / std::numbers::pi); }

}  // namespace

double radius_edge_ratio(const CellPoints& p) {
  const double shortest2 = squared_shortest_edge<double>(p);
  return shortest2 > 0 ? circumradius(p) / std::sqrt(shortest2) : std::numeric_limits<double>::infinity();
}

double circumradius(const CellPoints& p) {
  const auto [numerator, denominator] = squared_circumradius<double>(p);
  const double radius = std::sqrt(numerator / denominator);
  return denominator > 0 && std::isfinite(radius) ? radius : std::numeric_limits<double>::infinity();
}

std::array<double, 3> angles_deg(const TrianglePoints& p) {
  std::array<double, 3> angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto u = difference<double>(p[(i + 1) % 3], p[i]), v = difference<double>(p[(i + 2) % 3], p[i]);
    const auto normal = cross(u, v);
    angles[i] = degrees(std::atan2(std::sqrt(dot(normal, normal)), dot(u, v)));
  }
  return angles;
}

std::array<double, 6> dihedral_angles_deg(const CellPoints& p) {
  std::array<double, 6> angles{};
  for (std::size_t e = 0; e < 6; ++e) {
    const auto a = static_cast<std::size_t>(kEdges[e][0]), b = static_cast<std::size_t>(kEdges[e][1]);
    const auto c = static_cast<std::size_t>(kEdges[5 - e][0]), d = static_cast<std::size_t>(kEdges[5 - e][1]);
    const auto axis = difference<double>(p[b], p[a]);
    const auto u = cross(axis, difference<double>(p[c], p[a])),
               v = cross(axis, difference<double>(p[d], p[a]));
    const auto w = cross(u, v);
    angles[e] = degrees(std::atan2(std::sqrt(dot(w, w)), dot(u, v)));
  }
  return angles;
}

}  // namespace podm::verify
