// The planes of a flat box in the working frame, whose axes are those of the image (image/working_frame.h). A
// plane is a coordinate along one axis. A point is on a side if its set of sides says so; it then has exactly
// that coordinate.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "geometry/point.h"
#include "podm/box_sides.h"
#include "podm/label_image.h"

namespace podm {

/// A point of the isosurface, and the sides of the box that it is on.
struct SurfacePoint : Point {
  SideMask sides = 0;
};

class BoxPlanes {
 public:
  explicit BoxPlanes(const LabelImage& image);

  /// True if p is in the box or on its boundary.
  bool contains(const Point& p) const;
  /// The point of the box that is nearest to p, and the sides onto which p was moved.
  SurfacePoint clamped(const Point& p) const { return moved_onto_sides(p, 0); }
  /// Moves z onto all planes within kInPlane voxels of it, and into the box.
  SurfacePoint in_planes(const Point& z) const { return moved_onto_sides(z, kInPlane); }
  /// Moves z onto all planes within kSnap voxels of it, and into the box.
  SurfacePoint snapped(const Point& z) const { return moved_onto_sides(z, kSnap); }
  /// The same, but only onto the nearest planes that are within `reach_mm` together.
  SurfacePoint snapped(const SurfacePoint& z, double reach_mm) const {
    return onto_planes(z, kSnap, reach_mm);
  }
  /// Moves z onto the nearest planes that are within `reach_mm` together.
  SurfacePoint onto_planes(const SurfacePoint& z, double reach_mm) const {
    return onto_planes(z, std::numeric_limits<double>::infinity(), reach_mm);
  }
  /// Moves z onto the planes of these sides.
  Point moved_onto(SideMask sides, const Point& z) const;
  /// The projection of a point in the box onto the nearest plane.
  SurfacePoint nearest_on_side(const Point& p) const;
  /// The point at which the segment from a point in the box to one outside leaves the box.
  SurfacePoint exit(const Point& inside, const Point& outside) const;
  /// A point of the box on the segment between two points outside, if it passes through the box.
  std::optional<Point> middle_inside(const Point& a, const Point& b) const;

 private:
  // In the outermost half voxel the label function does not change along the axis. A point may therefore move
  // to the plane and stays on the isosurface. Points slightly beside a plane would only make small cells.
  static constexpr double kSnap = 0.45;
  // Vertices on lines stay as near to a plane as this, where their line ends.
  static constexpr double kInPlane = 0.01;

  struct Axis {
    double low = 0, high = 0, voxel_mm = 0;
    SideMask low_side = 0, high_side = 0;
  };
  SurfacePoint moved_onto_sides(const Point& p, double voxels) const;
  SurfacePoint onto_planes(const SurfacePoint& z, double voxels, double reach_mm) const;

  std::array<Axis, 3> axes_;  // of the working frame
};

}  // namespace podm
