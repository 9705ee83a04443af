#include "lines/face_points.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "lines/chains.h"
#include "lines/curve_points.h"
#include "lines/lattice.h"
#include "lines/tie_point.h"

namespace podm {

namespace {

Point centroid(const FaceTriangle& t) {
  const double u = t.u + (t.is_second ? 1.0 / 3 : 2.0 / 3), v = t.v + (t.is_second ? 2.0 / 3 : 1.0 / 3);
  return {u * kLatticeSide, v * kLatticeSide, 0.5};
}

struct Found {
  const FaceTriangle* triangle;
  Point uv;
  bool is_confirmed;
};

// Finds the point of each triangle; those that are confirmed come first.
std::vector<Found> points_of_triangles(const WeightForms& forms, const Box& box,
                                       const std::vector<FaceTriangle>& triangles) {
  std::vector<Found> found;
  for (const FaceTriangle& t : triangles) {
    SlotMask tied = 0;
    for (const LabelIndex label : t.labels) tied |= static_cast<SlotMask>(1u << forms.slot(label));
    const Point start = centroid(t);
    const std::optional<Point> point = tie_point(forms, tied, start, box, kCurveReach);
    found.push_back({&t, point.value_or(start), point.has_value()});
  }
  std::stable_partition(found.begin(), found.end(), [](const Found& f) { return f.is_confirmed; });
  return found;
}

bool has_new_labels(const FacePoint& point, const FewLabels& labels) {
  return std::any_of(labels.begin(), labels.end(), [&](LabelIndex l) { return !point.labels.contains(l); });
}

}  // namespace

std::vector<FacePoint> face_points(const WeightForms& forms, const Box& box,
                                   std::vector<FaceTriangle> triangles) {
  std::sort(triangles.begin(), triangles.end(), [](const FaceTriangle& a, const FaceTriangle& b) {
    return std::tie(a.v, a.u, a.is_second) < std::tie(b.v, b.u, b.is_second);
  });
  Box inside = box;
  inside.low.z = 0;
  inside.high.z = 1;
  std::vector<FacePoint> points;
  for (const auto& [triangle, uv, is_confirmed] : points_of_triangles(forms, inside, triangles)) {
    const auto near = std::find_if(points.begin(), points.end(),
                                   [&](const FacePoint& p) { return distance(p.uv, uv) < kMergeDistance; });
    if (near == points.end()) {
      points.push_back({uv, triangle->labels, is_confirmed, {triangle->index}});
      continue;
    }
    near->triangles.push_back(triangle->index);
    // Where other labels meet nearby the point lies halfway, so that it is close to all of them.
    if (is_confirmed && has_new_labels(*near, triangle->labels)) near->uv = near->uv + 0.5 * (uv - near->uv);
    near->labels.insert(triangle->labels);
  }
  return points;
}

}  // namespace podm
