// The points to which R7 tries to move a vertex, chosen from the vertex's surroundings alone.
//
//   First come points along the normal of the facet opposite to the vertex in the poor cell: a sliver lacks
//   height, and far enough from the facet's circumsphere it is no longer a Delaunay cell. Then come random
//   points in a ball. A point too near to another vertex is pushed away from it, and dropped if that brings
//   it too near to a third vertex.
#pragma once

#include <array>
#include <optional>
#include <random>
#include <vector>

#include "geometry/point.h"

namespace podm {

/// The number of random points tried per vertex, and their distance.
struct MoveEffort {
  unsigned num_random;
  double reach;  ///< of random points, as a multiple of the distance to the nearest vertex
};

class MovePoints {
 public:
  struct Neighbor {
    Point point;
    double spacing_mm;  // required distance from it
  };

  /// The vertices around the vertex; the caller lists them before begin().
  std::vector<Neighbor>& neighbors() { return neighbors_; }
  /// Starts the points of the vertex at `at`, in a cell with the vertices `others`.
  void begin(const Point& at, const std::array<Point, 3>& others, const MoveEffort& effort);
  /// True if next() has returned all points.
  bool is_over() const { return next_ == kAlongNormal.size() + effort_.num_random; }
  Point next(std::mt19937_64& random);
  /// Returns the point, or one near it, that keeps the spacing from all neighbors and is nearer to `at` than
  /// to any neighbor.
  std::optional<Point> spaced(Point p) const;
  /// True if p keeps the spacing from all neighbors and is nearer to `at` than to any neighbor.
  bool is_spaced(const Point& p) const;
  double reach_mm() const { return effort_.reach * shortest_; }

 private:
  // As multiples of the distance to the nearest vertex.
  static constexpr std::array kAlongNormal{0.1, 0.25, -0.1, -0.25};

  std::vector<Neighbor> neighbors_;
  Point at_;
  Vector normal_;        // towards the vertex
  double shortest_ = 0;  // to the nearest neighbor, mm
  MoveEffort effort_{};
  std::size_t next_ = 0;  // among all points
};

}  // namespace podm
