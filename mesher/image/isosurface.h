// The isosurface oracle: what the object's boundary is, and where its nearest point lies.
//
// The label at a point is the one with the greatest trilinear weight among the eight voxels around it, ties
// to the smaller label index; outside the grid everything is background. The isosurface is the set of points
// where that label changes. All coordinates are mm in the image frame (podm/label_image.h).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/point.h"
#include "podm/label_image.h"

namespace podm {

class Isosurface {
 public:
  /// Runs the feature transform on `threads` threads (0: all cores). Keeps a reference to `image`.
  Isosurface(const LabelImage& image, int threads);

  /// Greatest trilinear weight; a single look-up away from any label change.
  LabelIndex label_at(const Point& p) const;

  /// A lower bound of the distance from p to the isosurface, mm; 0 when p may lie on it. A few look-ups.
  double distance_lower_bound(const Point& p) const;

  /// A point of the isosurface as near to p as the feature transform, marching and local projection find,
  /// if one lies within `radius` of p. Its distance to the true isosurface is below 1e-6 voxel.
  std::optional<Point> closest_point(const Point& p, double radius) const;

  /// The point where the label changes along segment ab, searched from a; none if no change is found.
  /// If the labels at a and b differ one is always found. Otherwise the segment is sphere-traced with steps
  /// of at least half a voxel, so that a double crossing shorter than that may be missed.
  std::optional<Point> segment_intersection(const Point& a, const Point& b) const;
};

}  // namespace podm
