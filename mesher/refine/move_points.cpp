#include "refine/move_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace podm {

namespace {

constexpr double kLeastStep = 0.2;           // of random points, as a fraction of their reach
constexpr double kBeyondSpacing = 1 + 1e-6;  // the excess is larger than rounding errors
constexpr int kPushes = 3;

Vector random_in_unit_ball(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (;;) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    const double squared = x * x + y * y + z * z;
    if (squared <= 1 && squared >= kLeastStep * kLeastStep) return {x, y, z};
  }
}

}  // namespace

void MovePoints::begin(const Point& at, const std::array<Point, 3>& others, const MoveEffort& effort) {
  at_ = at;
  effort_ = effort;
  next_ = 0;
  double squared = std::numeric_limits<double>::infinity();
  for (const Neighbor& neighbor : neighbors_)
    squared = std::min(squared, squared_distance(neighbor.point, at));
  shortest_ = std::sqrt(squared);
  const Vector normal = cross(others[1] - others[0], others[2] - others[0]);
  const double side = dot(normal, at - others[0]) < 0 ? -1 : 1;
  normal_ = (side / std::sqrt(squared_length(normal))) * normal;
}

Point MovePoints::next(std::mt19937_64& random) {
  const std::size_t i = next_++;
  if (i < kAlongNormal.size()) return at_ + (kAlongNormal[i] * shortest_) * normal_;
  return at_ + (effort_.reach * shortest_) * random_in_unit_ball(random);
}

std::optional<Point> MovePoints::spaced(Point p) const {
  for (int i = 0; i < kPushes; ++i) {
    bool is_clear = true;
    for (const auto& [point, spacing_mm] : neighbors_) {
      const double squared = squared_distance(point, p);
      if (squared >= spacing_mm * spacing_mm) continue;
      p = point + (kBeyondSpacing * spacing_mm / std::sqrt(squared)) * (p - point);
      is_clear = false;
    }
    if (is_clear) break;
  }
  return is_spaced(p) ? std::optional(p) : std::nullopt;
}

bool MovePoints::is_spaced(const Point& p) const {
  const double squared_step = squared_distance(p, at_);
  return std::all_of(neighbors_.begin(), neighbors_.end(), [&](const Neighbor& neighbor) {
    const double squared = squared_distance(neighbor.point, p);
    return squared >= neighbor.spacing_mm * neighbor.spacing_mm && squared_step < squared;
  });
}

}  // namespace podm
