#include "phantoms/phantom_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace podm {

namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();
constexpr double kSmoothStepMm = 5;

Point lowest(const Point& a, const Point& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

Point highest(const Point& a, const Point& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

double to_tube_part(const Point& p, const Knot& a, const Knot& b) {
  const Vector along = b.at - a.at;
  const double t = std::clamp(dot(p - a.at, along) / squared_length(along), 0.0, 1.0);
  return distance(p, a.at + t * along) - (a.radius + t * (b.radius - a.radius));
}

double catmull_rom(double a, double b, double c, double d, double t) {
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

Knot catmull_rom(const Knot& a, const Knot& b, const Knot& c, const Knot& d, double t) {
  return {{catmull_rom(a.at.x, b.at.x, c.at.x, d.at.x, t), catmull_rom(a.at.y, b.at.y, c.at.y, d.at.y, t),
           catmull_rom(a.at.z, b.at.z, c.at.z, d.at.z, t)},
          catmull_rom(a.radius, b.radius, c.radius, d.radius, t)};
}

std::vector<Knot> knots_of(const std::vector<Point>& path, double radius) {
  std::vector<Knot> knots;
  for (const Point& p : path) knots.push_back({p, radius});
  return knots;
}

}  // namespace

Shape ellipsoid(const Point& centre, const Vector& radii) {
  return {[=](const Point& p) {
            const double x = (p.x - centre.x) / radii.x, y = (p.y - centre.y) / radii.y,
                         z = (p.z - centre.z) / radii.z;
            return x * x + y * y + z * z - 1;
          },
          centre - radii, centre + radii};
}

Shape dome(const Point& centre, const Vector& radii) {
  Shape shape = ellipsoid(centre, radii);
  shape.value = [=, half = shape.value](const Point& p) { return half({p.x, p.y, std::max(p.z, centre.z)}); };
  shape.low.z = -kEverywhere;
  return shape;
}

Shape torus(double ring_radius, double tube_radius) {
  const double reach = ring_radius + tube_radius;
  return {[=](const Point& p) { return std::hypot(std::hypot(p.x, p.y) - ring_radius, p.z) - tube_radius; },
          {-reach, -reach, -tube_radius},
          {reach, reach, tube_radius}};
}

Shape slab(const Point& centre, const Vector& half_extent) {
  return {[=](const Point& p) {
            const double x = (p.x - centre.x) / half_extent.x, y = (p.y - centre.y) / half_extent.y,
                         z = (p.z - centre.z) / half_extent.z;
            const double xx = x * x, yy = y * y, z4 = z * z * z * z;
            return xx + yy - kSlabSquareness * std::min(xx, 1.0) * std::min(yy, 1.0) + z4 * z4 - 1;
          },
          centre - half_extent, centre + half_extent};
}

Point on_slab_outline(const Vector& half_extent, double angle, double z) {
  const double x = std::sin(angle), y = -std::cos(angle);
  // r solves rr - mixed * rr^2 = 1, in a form without a special case for mixed = 0.
  const double mixed = kSlabSquareness * x * x * y * y;
  const double r = std::sqrt(2 / (1 + std::sqrt(1 - 4 * mixed)));
  return {half_extent.x * r * x, half_extent.y * r * y, z};
}

Shape tube(const std::vector<Knot>& knots) {
  Point low{kEverywhere, kEverywhere, kEverywhere}, high = -1.0 * low;
  for (const Knot& knot : knots) {
    const Vector r{knot.radius, knot.radius, knot.radius};
    low = lowest(low, knot.at - r);
    high = highest(high, knot.at + r);
  }
  return {[=](const Point& p) {
            double nearest = kEverywhere;
            for (std::size_t i = 0; i + 1 < knots.size() && nearest >= 0; ++i) {
              nearest = std::min(nearest, to_tube_part(p, knots[i], knots[i + 1]));
            }
            return nearest;
          },
          low, high};
}

Shape tube(const std::vector<Point>& path, double radius) { return tube(knots_of(path, radius)); }

std::vector<Knot> smooth(const std::vector<Knot>& knots) {
  std::vector<Knot> curve;
  const std::size_t last = knots.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const Knot &before = knots[i == 0 ? 0 : i - 1], &after = knots[std::min(i + 2, last)];
    const double steps = std::ceil(distance(knots[i].at, knots[i + 1].at) / kSmoothStepMm);
    for (double step = 0; step < steps; ++step) {
      curve.push_back(catmull_rom(before, knots[i], knots[i + 1], after, step / steps));
    }
  }
  curve.push_back(knots[last]);
  return curve;
}

std::vector<Knot> smooth(const std::vector<Point>& path, double radius) {
  return smooth(knots_of(path, radius));
}

std::vector<Knot> widened(std::vector<Knot> knots, double mm) {
  for (Knot& knot : knots) knot.radius += mm;
  return knots;
}

std::vector<Knot> waved(std::vector<Knot> knots, double amplitude, double period) {
  double way = 0;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (i > 0) way += distance(knots[i - 1].at, knots[i].at);
    knots[i].radius += amplitude * std::cos(2 * std::numbers::pi * way / period);
  }
  return knots;
}

Shape in_front_of(double level) {
  return {[=](const Point& p) { return level - p.y; },
          {-kEverywhere, level, -kEverywhere},
          {kEverywhere, kEverywhere, kEverywhere}};
}

Shape above(double level) {
  return {[=](const Point& p) { return level - p.z; },
          {-kEverywhere, -kEverywhere, level},
          {kEverywhere, kEverywhere, kEverywhere}};
}

Shape coronal_sheet(double level, double thickness) {
  return {[=](const Point& p) { return std::abs(p.y - level) - thickness / 2; },
          {-kEverywhere, level - thickness / 2, -kEverywhere},
          {kEverywhere, level + thickness / 2, kEverywhere}};
}

Shape within(const Shape& a, const Shape& b) {
  return {[a = a.value, b = b.value](const Point& p) { return std::max(a(p), b(p)); }, highest(a.low, b.low),
          lowest(a.high, b.high)};
}

Shape without(const Shape& a, const Shape& b) {
  return {[a = a.value, b = b.value](const Point& p) { return std::max(a(p), -b(p)); }, a.low, a.high};
}

Shape mirrored(const Shape& shape) {
  return {[value = shape.value](const Point& p) {
            return value({-p.x, p.y, p.z});
          },
          {-shape.high.x, shape.low.y, shape.low.z},
          {-shape.low.x, shape.high.y, shape.high.z}};
}

Shape leaning(const Shape& shape, const Point& centre, double degrees) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  const double reach = std::hypot(std::max(shape.high.x - centre.x, centre.x - shape.low.x),
                                  std::max(shape.high.z - centre.z, centre.z - shape.low.z));
  return {[=, value = shape.value](const Point& p) {
            const double x = p.x - centre.x, z = p.z - centre.z;
            return value({centre.x + c * x - s * z, p.y, centre.z + s * x + c * z});
          },
          {centre.x - reach, shape.low.y, centre.z - reach},
          {centre.x + reach, shape.high.y, centre.z + reach}};
}

}  // namespace podm
