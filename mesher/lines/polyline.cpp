#include "lines/polyline.h"

#include <algorithm>
#include <limits>

namespace podm {

namespace {

Point nearest_on_segment(const Point& a, const Point& b, const Point& p) {
  const Vector d = b - a;
  const double squared = squared_length(d);
  return squared > 0 ? a + std::clamp(dot(p - a, d) / squared, 0.0, 1.0) * d : a;
}

// Marks the points to keep between two that are kept.
void mark_needed(const std::vector<Point>& points, std::size_t first, std::size_t last, double tolerance,
                 std::vector<bool>& is_needed) {
  double farthest = tolerance;
  std::size_t split = 0;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double d = distance(points[i], nearest_on_segment(points[first], points[last], points[i]));
    if (d <= farthest) continue;
    farthest = d;
    split = i;
  }
  if (split == 0) return;
  is_needed[split] = true;
  mark_needed(points, first, split, tolerance, is_needed);
  mark_needed(points, split, last, tolerance, is_needed);
}

}  // namespace

double length(Polyline line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += distance(line[i - 1], line[i]);
  return sum;
}

Approach nearest_on(Polyline line, const Point& p) {
  Approach nearest{std::numeric_limits<double>::infinity(), {}, 0};
  for (std::size_t s = 0; s + 1 < line.size(); ++s) {
    const Point q = nearest_on_segment(line[s], line[s + 1], p);
    const double d = distance(p, q);
    if (d < nearest.distance) nearest = {d, q, s};
  }
  return nearest;
}

// Minimises over the shares in turn until both are at their minimum, or clamped: Ericson, Real-Time Collision
// Detection, 5.1.9.
std::pair<double, double> nearest_shares(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Vector u = b - a, v = d - c, w = a - c;
  const double uu = squared_length(u), vv = squared_length(v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const auto share = [](double x, double of) { return of > 0 ? std::clamp(x / of, 0.0, 1.0) : 0.0; };
  const double s = share(uv * vw - uw * vv, uu * vv - uv * uv);
  const double t = share(uv * s + vw, vv);
  return {share(uv * t - uw, uu), t};
}

double greatest_distance_from(const Point& center, Polyline line) {
  double greatest = 0;
  for (const Point& p : line) greatest = std::max(greatest, distance(center, p));
  return greatest;
}

double greatest_distance(Polyline line, Polyline other) {
  double greatest = 0;
  for (const Point& p : line) greatest = std::max(greatest, nearest_on(other, p).distance);
  return greatest;
}

bool are_within(Polyline a, Polyline b, double distance) {
  return greatest_distance(a, b) <= distance && greatest_distance(b, a) <= distance;
}

void remove_reversals(std::vector<Point>& points) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    while (kept > 1 && dot(points[kept - 1] - points[kept - 2], points[i] - points[kept - 1]) < 0) --kept;
    points[kept++] = points[i];
  }
  points.resize(kept);
}

void remove_repeated(std::vector<Point>& points, double distance) {
  const auto is_near = [&](const Point& p, const Point& q) { return podm::distance(p, q) < distance; };
  std::size_t kept = 1;
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    if (!is_near(points[i], points[kept - 1]) && !is_near(points[i], points.back()))
      points[kept++] = points[i];
  points[kept++] = points.back();
  points.resize(kept);
}

void simplify(std::vector<Point>& points, double tolerance) {
  if (points.size() < 3) return;
  std::vector<bool> is_needed(points.size());
  const std::size_t last = points.size() - 1;
  is_needed.front() = is_needed.back() = true;
  if (points.front() == points.back()) {
    // Three points of a closed polyline that are never removed.
    for (const std::size_t third : {last / 3, 2 * last / 3}) is_needed[third] = true;
    mark_needed(points, 0, last / 3, tolerance, is_needed);
    mark_needed(points, last / 3, 2 * last / 3, tolerance, is_needed);
    mark_needed(points, 2 * last / 3, last, tolerance, is_needed);
  } else {
    mark_needed(points, 0, last, tolerance, is_needed);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_needed[i]) points[kept++] = points[i];
  points.resize(kept);
}

}  // namespace podm
