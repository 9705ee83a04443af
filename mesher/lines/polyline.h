// Polylines, in any unit of length.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "geometry/point.h"

namespace podm {

using Polyline = std::span<const Point>;

double length(Polyline line);

/// The point of a polyline that is nearest to something.
struct Approach {
  double distance;
  Point point;
  std::size_t segment;  // that holds the point
};
/// The point of a polyline nearest to p. The polyline must have two points.
Approach nearest_on(Polyline line, const Point& p);
/// The nearest points of two segments, as shares of each.
std::pair<double, double> nearest_shares(const Point& a, const Point& b, const Point& c, const Point& d);
/// The greatest distance of a point of the polyline from `center`.
double greatest_distance_from(const Point& center, Polyline line);
/// The greatest distance of a point of `line` from the polyline `other`.
double greatest_distance(Polyline line, Polyline other);
/// True if neither polyline leaves the other by more than `distance`.
bool are_within(Polyline a, Polyline b, double distance);

/// Removes points between which a polyline turns back, by more than a right angle.
void remove_reversals(std::vector<Point>& points);
/// Removes points between the ends that are closer than `distance` to the point before them, or to the end.
void remove_repeated(std::vector<Point>& points, double distance);
/// Keeps the points that a polyline needs so that none of the removed ones is farther than `tolerance` from
/// it (Douglas, Peucker). A closed polyline keeps at least three different points.
void simplify(std::vector<Point>& points, double tolerance);

}  // namespace podm
