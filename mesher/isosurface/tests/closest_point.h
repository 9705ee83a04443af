// The isosurface point nearest to p within a radius, found and polished as in rule R1.
#pragma once

#include <optional>

#include "isosurface/isosurface.h"

namespace podm::test {

template <class Reads>
std::optional<Point> closest_point(const Oracle<Reads>& oracle, const Point& p, double radius) {
  const std::optional<NearPoint> near = oracle.near_point(p, radius);
  if (!near) return std::nullopt;
  const Point z = oracle.polished(*near, p);
  return squared_distance(z, p) <= radius * radius ? std::optional(z) : std::nullopt;
}

}  // namespace podm::test
