// Where to a vertex may move, by its surroundings alone: the points that R7 tries.
//
//   First along the normal of the facet opposite to it in the poor cell: a sliver lacks height, and far
//   enough from its circumsphere it is no Delaunay cell any more. Then at random in a ball. A point too near
//   to another vertex is pushed off it, and dropped if that takes it to a third.
#pragma once

#include <array>
#include <optional>
#include <random>
#include <vector>

#include "geometry/point.h"

namespace podm {

/// How many points are tried of a vertex, and how far they are.
struct MoveEffort {
  unsigned num_random;
  double reach;  ///< of random points, over the distance to the nearest vertex
};

class MovePoints {
 public:
  struct Neighbor {
    Point point;
    double spacing_mm;  // to be kept from it
  };

  /// What surrounds the vertex; the caller lists it before begin().
  std::vector<Neighbor>& neighbors() { return neighbors_; }
  /// The vertex is at `at`, in a cell with the `others`.
  void begin(const Point& at, const std::array<Point, 3>& others, const MoveEffort& effort);
  /// Points, some more to come: is_over() tells.
  bool is_over() const { return next_ == kAlongNormal.size() + effort_.num_random; }
  Point next(std::mt19937_64& random);
  /// The point, or one near it, that keeps the spacing from all neighbours and is nearer to `at` than any is.
  std::optional<Point> spaced(Point p) const;
  /// Whether it is such a point.
  bool is_spaced(const Point& p) const;
  double reach_mm() const { return effort_.reach * shortest_; }

 private:
  // Over the distance to the nearest vertex.
  static constexpr std::array kAlongNormal{0.1, 0.25, -0.1, -0.25};

  std::vector<Neighbor> neighbors_;
  Point at_;
  Vector normal_;        // towards the vertex
  double shortest_ = 0;  // mm, to the nearest neighbour
  MoveEffort effort_{};
  std::size_t next_ = 0;  // of all points
};

}  // namespace podm
