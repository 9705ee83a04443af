// Implicit shapes for the phantoms: negative inside, coordinates in mm. Only the sign of a value matters.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "geometry/point.h"

namespace podm {

/// Points outside [low, high] are outside the shape. Most points are therefore never evaluated.
struct Shape {
  std::function<double(const Point&)> value;
  Point low, high;
};

/// A part of a phantom. Parts of a list may share a label. Later parts cover earlier ones.
struct Organ {
  std::uint32_t label;
  std::string name;
  Shape shape;
};

Shape ellipsoid(const Point& centre, const Vector& radii);

/// The upper half of an ellipsoid on an elliptic cylinder without a lower end.
Shape dome(const Point& centre, const Vector& radii);

/// A torus around the z axis through the origin.
Shape torus(double ring_radius, double tube_radius);

/// The shape of slab() seen along z, between an ellipse (0) and a rectangle (1).
inline constexpr double kSlabSquareness = 0.42;
/// A slab is nearly elliptic seen along z. It is flat at top and bottom, with a rounded rim.
Shape slab(const Point& centre, const Vector& half_extent);
/// The point on the outline of a slab around the origin at `angle` radians from -y towards +x.
Point on_slab_outline(const Vector& half_extent, double angle, double z);

/// A point of a tube's axis and the tube's radius there.
struct Knot {
  Point at;
  double radius;
};

/// A tube of balls whose centers and radii vary linearly from knot to knot.
Shape tube(const std::vector<Knot>& knots);
Shape tube(const std::vector<Point>& path, double radius);

/// A smooth curve through the knots (Catmull-Rom), as knots at most about 5 mm apart.
std::vector<Knot> smooth(const std::vector<Knot>& knots);
std::vector<Knot> smooth(const std::vector<Point>& path, double radius);
/// Increases every radius by `mm`, which may be negative.
std::vector<Knot> widened(std::vector<Knot> knots, double mm);
/// Varies the radii by `amplitude`, with one period per `period` mm along the path.
std::vector<Knot> waved(std::vector<Knot> knots, double amplitude, double period);

/// The half space y > `level`.
Shape in_front_of(double level);
/// The half space z > `level`.
Shape above(double level);

/// The sheet |y - `level`| < `thickness` / 2.
Shape coronal_sheet(double level, double thickness);

Shape within(const Shape& a, const Shape& b);   ///< intersection
Shape without(const Shape& a, const Shape& b);  ///< difference
Shape mirrored(const Shape& shape);             ///< at the plane x = 0
/// Turns the shape about the line through `centre` along y, from z towards x.
Shape leaning(const Shape& shape, const Point& centre, double degrees);

}  // namespace podm
