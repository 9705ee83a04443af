// The intersection of two balls.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/point.h"

namespace podm {

struct Ball {
  Point center;
  double radius;
};

/// Returns an upper bound of the distance from q to the points in both balls; except for rounding it is the
/// least one. Negative if no point is in both. If the farthest point of one ball lies in the other ball, it
/// is the farthest of both. Otherwise the farthest point of both lies where the spheres meet.
inline double farthest_in_both(const Point& q, const Ball& a, const Ball& b) {
  const Vector axis = b.center - a.center;
  const double d = std::sqrt(squared_length(axis));
  if (d > a.radius + b.radius) return -1;
  const auto farthest = [&](const Ball& of) { return distance(q, of.center) + of.radius; };
  const auto has_farthest = [&](const Ball& of, const Ball& other) {
    const Vector away = of.center - q;
    const double length = std::sqrt(squared_length(away));
    if (length == 0) return true;
    return distance(of.center + (of.radius / length) * away, other.center) <= other.radius;
  };
  if (has_farthest(a, b)) return farthest(a);
  if (has_farthest(b, a)) return farthest(b);
  // The circle in which the spheres meet lies at `along` from a's center.
  const double along = (d * d + a.radius * a.radius - b.radius * b.radius) / (2 * d);
  const double circle = std::sqrt(std::max(0.0, a.radius * a.radius - along * along));
  const Vector to_q = q - a.center;
  const double q_along = dot(to_q, axis) / d;
  const double q_across = std::sqrt(std::max(0.0, squared_length(to_q) - q_along * q_along));
  return std::hypot(q_along - along, q_across + circle);
}

}  // namespace podm
