// Implicit shapes for the phantoms: negative inside, in mm.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "geometry/point.h"

namespace podm {

/// Points outside [low, high] are outside the shape, so that most are never evaluated.
struct Shape {
  std::function<double(const Point&)> value;
  Point low, high;
};

struct Organ {
  std::uint32_t label;
  std::string name;
  Shape shape;  // later organs of a list cover earlier ones
};

inline Shape superellipsoid(const Point& c, const Vector& r, double power_xy, double power_z) {
  return {[=](const Point& p) {
            const double x = std::abs(p.x - c.x) / r.x, y = std::abs(p.y - c.y) / r.y,
                         z = std::abs(p.z - c.z) / r.z;
            return std::pow(x, power_xy) + std::pow(y, power_xy) + std::pow(z, power_z) - 1;
          },
          c - r, c + r};
}

inline Shape ellipsoid(const Point& c, const Vector& r) {
  return {[=](const Point& p) {
            const double x = (p.x - c.x) / r.x, y = (p.y - c.y) / r.y, z = (p.z - c.z) / r.z;
            return x * x + y * y + z * z - 1;
          },
          c - r, c + r};
}

inline double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const Vector ab = b - a;
  const double t = std::clamp(dot(p - a, ab) / squared_length(ab), 0.0, 1.0);
  return distance(p, a + t * ab);
}

/// A tube of one radius along a polyline.
inline Shape tube(const std::vector<Point>& path, double radius) {
  Point low = path[0], high = path[0];
  for (const Point& p : path) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vector r{radius, radius, radius};
  return {[=](const Point& p) {
            double nearest = 1e9;
            for (std::size_t i = 0; i + 1 < path.size(); ++i) {
              nearest = std::min(nearest, distance_to_segment(p, path[i], path[i + 1]));
            }
            return nearest - radius;
          },
          low - r, high + r};
}

/// A point on an ellipse around the z axis, tilted by `rise` mm from back to front.
inline Point on_ellipse(double angle, double rx, double ry, double z, double rise) {
  return {rx * std::sin(angle), -ry * std::cos(angle), z + rise * (1 - std::cos(angle)) / 2};
}

inline Shape without(const Shape& a, const Shape& b) {
  return {[=](const Point& p) { return std::max(a.value(p), -b.value(p)); }, a.low, a.high};
}

inline Shape within(const Shape& a, const Shape& b) {
  return {[=](const Point& p) { return std::max(a.value(p), b.value(p)); }, a.low, a.high};
}

}  // namespace podm
