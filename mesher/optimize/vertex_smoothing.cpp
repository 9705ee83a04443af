#include "optimize/vertex_smoothing.h"

#include <cmath>
#include <limits>

namespace podm {

namespace {

// Returns the convex combination of the vectors that is nearest to the origin, by a few iterations of
// Gilbert's algorithm: each goes towards the vector that lies farthest back.
Vector nearest_mixture(const std::vector<Vector>& vectors) {
  constexpr int kTurns = 12;
  Vector x = vectors.front();
  for (int turn = 0; turn < kTurns; ++turn) {
    const Vector* lowest = &vectors.front();
    for (const Vector& v : vectors)
      if (dot(v, x) < dot(*lowest, x)) lowest = &v;
    const Vector way = *lowest - x;
    const double length2 = squared_length(way);
    if (length2 == 0 || dot(x, way) >= 0) break;
    x = x + std::min(1.0, -dot(x, way) / length2) * way;
  }
  return x;
}

}  // namespace

double VertexSmoothing::worst(const Point& at, double floor) const {
  double worst = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < triangles_.size() && worst > floor; ++i) worst = std::min(worst, cell(i, at));
  return worst;
}

// Returns the direction in which all nearly worst cells improve; its length is the rate. 0: there is none.
Vector VertexSmoothing::ascent(const Point& at, double scale) {
  constexpr double kNearlyWorst = 1.3;
  double worst = std::numeric_limits<double>::infinity();
  values_.clear();
  for (const Triangle& t : triangles_) {
    values_.push_back(quality_.of({t.a, t.b, t.c, at}));
    worst = std::min(worst, values_.back());
  }
  gradients_.clear();
  const double h = 1e-4 * scale;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (values_[i] > kNearlyWorst * worst) continue;
    const Triangle& t = triangles_[i];
    const auto slope = [&](const Vector& step) {
      return (quality_.of({t.a, t.b, t.c, at + step}) - values_[i]) / h;
    };
    gradients_.push_back({slope({h, 0, 0}), slope({0, h, 0}), slope({0, 0, h})});
  }
  return nearest_mixture(gradients_);
}

bool VertexSmoothing::move(const std::vector<Point>& points, const std::vector<LocalFacet>& facets,
                           const LabelBound& bound, double floor, Point& at) {
  bound_ = bound;
  triangles_.clear();
  double shortest2 = std::numeric_limits<double>::infinity();
  for (const LocalFacet& f : facets) {
    triangles_.push_back({points[f[0]], points[f[1]], points[f[2]]});
    for (const Local v : f) shortest2 = std::min(shortest2, squared_distance(points[v], at));
  }
  const double scale = std::sqrt(shortest2);
  double best = floor, length = scale / 8;
  bool is_better = false;
  for (unsigned step = 0; step < kMaxSteps && best < 1; ++step) {
    const Vector way = ascent(at, scale);
    const double slope = std::sqrt(squared_length(way));
    if (slope == 0) break;
    unsigned halvings = 0;
    for (;; ++halvings) {
      if (halvings == kMaxHalvings) return is_better;
      const Point to = at + (length / slope) * way;
      if (const double quality = worst(to, best); quality > best) {
        at = to;
        best = quality;
        is_better = true;
        break;
      }
      length /= 2;
    }
    if (halvings == 0) length *= 2;
  }
  return is_better;
}

}  // namespace podm
