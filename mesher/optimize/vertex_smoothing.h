// Smoothing by non-smooth optimisation: moves a vertex to where the worst of the cells around it is
// best. The worst cells change on the way, so the worst quality has no gradient. The direction of ascent is
// the point nearest to the origin among the convex combinations of the gradients of all nearly worst cells
// (Freitag, Jones, Plassmann, "An efficient parallel algorithm for mesh smoothing", 1995).
#pragma once

#include <vector>

#include "optimize/cavity.h"

namespace podm {

class VertexSmoothing {
 public:
  explicit VertexSmoothing(const OptimizationQuality& quality) : quality_(quality) {}

  /// The vertex at `at` has these facets opposite it, each counter-clockwise seen from it. Moves it to where
  /// the worst cell is better than `floor`, or returns false.
  bool move(const std::vector<Point>& points, const std::vector<LocalFacet>& facets, const LabelBound& bound,
            double floor, Point& at);

 private:
  static constexpr unsigned kMaxSteps = 10, kMaxHalvings = 6;

  double cell(std::size_t i, const Point& at) const {
    const Triangle& t = triangles_[i];
    return quality_.of_new({t.a, t.b, t.c, at}, bound_);
  }
  double worst(const Point& at, double floor) const;  // exact only if better than `floor`
  Vector ascent(const Point& at, double scale);

  struct Triangle {
    Point a, b, c;
  };
  const OptimizationQuality& quality_;
  LabelBound bound_;
  std::vector<Triangle> triangles_;
  std::vector<double> values_;
  std::vector<Vector> gradients_;
};

}  // namespace podm
