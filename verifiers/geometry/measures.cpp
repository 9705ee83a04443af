#include "geometry/measures.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace podm::verify {

namespace {

double degrees(double radians) { return radians * (180 / std::numbers::pi); }

}  // namespace

std::array<int, 2> shortest_edge(const CellPoints& p, std::uint64_t& num_exact) {
  std::array<int, 2> best = kEdges[0];
  for (const auto& edge : kEdges) {
    if (edge == best) continue;
    const auto longer = [&]<class T>(T) {
      return squared_length<T>(p[static_cast<std::size_t>(edge[0])], p[static_cast<std::size_t>(edge[1])]) -
             squared_length<T>(p[static_cast<std::size_t>(best[0])], p[static_cast<std::size_t>(best[1])]);
    };
    if (sign_of(longer, num_exact) < 0) best = edge;
  }
  return best;
}

double radius_edge_ratio(const CellPoints& p) {
  double shortest2 = std::numeric_limits<double>::infinity();
  for (const auto& edge : kEdges)
    shortest2 = std::min(shortest2, squared_length<double>(p[static_cast<std::size_t>(edge[0])],
                                                           p[static_cast<std::size_t>(edge[1])]));
  return shortest2 > 0 ? circumradius(p) / std::sqrt(shortest2) : std::numeric_limits<double>::infinity();
}

double circumradius(const CellPoints& p) {
  const Fraction<double> squared = squared_circumradius<double>(p);
  return squared.denominator > 0 ? std::sqrt(squared.numerator / squared.denominator)
                                 : std::numeric_limits<double>::infinity();
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
