#include "lines/arc.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace podm {

namespace {

// The share of segment ab at which it is nearest to p.
double nearest_share(const Point& a, const Point& b, const Point& p) {
  const Vector d = b - a;
  const double squared = squared_length(d);
  return squared > 0 ? std::clamp(dot(p - a, d) / squared, 0.0, 1.0) : 0.0;
}

double distance_to_segment(const Point& a, const Point& b, const Point& p) {
  return distance(a + nearest_share(a, b, p) * (b - a), p);
}

}  // namespace

Arc::Arc(const LineArc& arc) : arc_(&arc), lengths_{0} {
  for (std::size_t i = 1; i < arc.points.size(); ++i)
    lengths_.push_back(lengths_.back() + distance(arc.points[i - 1], arc.points[i]));
}

double Arc::wrapped(double position) const {
  if (!is_closed()) return std::clamp(position, 0.0, length());
  const double rest = position - length() * std::floor(position / length());
  return rest < length() ? rest : 0;  // rounding may give the whole length
}

// The segment that begins at or before the position, which must be wrapped.
std::size_t Arc::segment_at(double position) const {
  const auto after = std::upper_bound(lengths_.begin(), lengths_.end(), position);
  const auto segment = static_cast<std::size_t>(after - lengths_.begin()) - 1;
  return std::min(segment, lengths_.size() - 2);
}

Point Arc::point_at(double position) const {
  const double at = wrapped(position);
  const std::size_t s = segment_at(at);
  const std::vector<Point>& points = arc_->points;
  if (at >= lengths_[s + 1]) return points[s + 1];
  const double share = (at - lengths_[s]) / (lengths_[s + 1] - lengths_[s]);
  return points[s] + share * (points[s + 1] - points[s]);
}

Vector Arc::direction_at(double position) const {
  const std::size_t s = segment_at(wrapped(position));
  const Vector d = arc_->points[s + 1] - arc_->points[s];
  return (1 / std::sqrt(squared_length(d))) * d;
}

double Arc::nearest_position(const Point& p) const {
  double position = 0, least = std::numeric_limits<double>::infinity();
  const std::vector<Point>& points = arc_->points;
  for (std::size_t s = 0; s + 1 < points.size(); ++s) {
    const double share = nearest_share(points[s], points[s + 1], p);
    const double squared = squared_distance(points[s] + share * (points[s + 1] - points[s]), p);
    if (squared >= least) continue;
    least = squared;
    position = lengths_[s] + share * (lengths_[s + 1] - lengths_[s]);
  }
  return position;
}

double Arc::length_between(double from, double to) const {
  const double length = to - from;
  return is_closed() && length < 0 ? length + this->length() : length;
}

// The distance from a segment is convex along another. Its maximum is therefore at a point of the polyline.
double Arc::chord_deviation(double from, double to) const {
  const Point a = point_at(from), b = point_at(to);
  const int turns = is_closed() ? 2 : 1;
  from = wrapped(from);
  to = wrapped(to) + (is_closed() && wrapped(to) < from ? length() : 0);
  double deviation = 0;
  for (int turn = 0; turn < turns; ++turn) {
    const double offset = turn * length();
    const auto first = std::upper_bound(lengths_.begin(), lengths_.end(), from - offset);
    const auto last = std::lower_bound(first, lengths_.end(), to - offset);
    for (auto i = first; i < last; ++i) {
      const Point& p = arc_->points[static_cast<std::size_t>(i - lengths_.begin())];
      deviation = std::max(deviation, distance_to_segment(a, b, p));
    }
  }
  return deviation;
}

}  // namespace podm
