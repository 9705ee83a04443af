#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "isosurface/tests/isosurface_reference.h"
#include "lines/arc.h"

namespace podm::test {
namespace {

LineArc random_arc(Random& random, bool is_closed) {
  LineArc arc;
  for (int i = 0; i < 40; ++i)
    arc.points.push_back({uniform(random, 0, 9), uniform(random, 0, 9), uniform(random, 0, 9)});
  if (is_closed)
    arc.points.push_back(arc.points.front());
  else
    arc.first_node = 0, arc.last_node = 1;
  return arc;
}

LineArc circle(double radius, int num_points) {
  LineArc arc;
  for (int i = 0; i < num_points; ++i) {
    const double angle = 2 * std::numbers::pi * i / num_points;
    arc.points.push_back({radius * std::cos(angle), radius * std::sin(angle), 1});
  }
  arc.points.push_back(arc.points.front());
  return arc;
}

TEST(Arc, OpenArcEndsInItsEnds) {
  Random random(1);
  const LineArc line = random_arc(random, false);
  const Arc arc(line);
  EXPECT_EQ(arc.point_at(0), line.points.front());
  EXPECT_EQ(arc.point_at(-1), line.points.front());
  EXPECT_EQ(arc.point_at(arc.length()), line.points.back());
  EXPECT_EQ(arc.point_at(arc.length() + 5), line.points.back());
}

TEST(Arc, LengthBetweenPointsIsAtLeastTheirDistance) {
  Random random(2);
  for (const bool is_closed : {false, true}) {
    const LineArc line = random_arc(random, is_closed);
    const Arc arc(line);
    for (int time = 0; time < 1000; ++time) {
      const double a = uniform(random, 0, arc.length()), b = uniform(random, 0, arc.length());
      const double from = is_closed ? a : std::min(a, b), to = is_closed ? b : std::max(a, b);
      EXPECT_GE(arc.length_between(from, to) + 1e-9, distance(arc.point_at(from), arc.point_at(to)));
    }
  }
}

TEST(Arc, NearestPositionOfAPointOnTheArcIsAtThatPoint) {
  Random random(3);
  const LineArc line = random_arc(random, true);
  const Arc arc(line);
  for (int time = 0; time < 1000; ++time) {
    const Point p = arc.point_at(uniform(random, 0, arc.length()));
    EXPECT_LT(distance(arc.point_at(arc.nearest_position(p)), p), 1e-9);
  }
}

TEST(Arc, NearestPositionIsNearerThanSampledOnes) {
  Random random(4);
  const LineArc line = random_arc(random, false);
  const Arc arc(line);
  for (int time = 0; time < 200; ++time) {
    const Point p{uniform(random, -2, 11), uniform(random, -2, 11), uniform(random, -2, 11)};
    const double nearest = distance(arc.point_at(arc.nearest_position(p)), p);
    for (double s = 0; s < arc.length(); s += 0.5) EXPECT_LE(nearest, distance(arc.point_at(s), p) + 1e-9);
  }
}

TEST(Arc, PositionsOfAClosedArcRepeat) {
  Random random(5);
  const LineArc line = random_arc(random, true);
  const Arc arc(line);
  for (int time = 0; time < 1000; ++time) {
    const double s = uniform(random, 0, arc.length());
    EXPECT_LT(distance(arc.point_at(s), arc.point_at(s + arc.length())), 1e-9);
    EXPECT_LT(distance(arc.point_at(s), arc.point_at(s - 3 * arc.length())), 1e-9);
  }
}

// Samples the arc between two positions; a chord deviation must bound them and be reached by one.
TEST(Arc, ChordDeviationIsTheGreatestDistanceFromTheChord) {
  Random random(6);
  for (const bool is_closed : {false, true}) {
    const LineArc line = random_arc(random, is_closed);
    const Arc arc(line);
    for (int time = 0; time < 60; ++time) {
      const double a = uniform(random, 0, arc.length()), b = uniform(random, 0, arc.length());
      const double from = is_closed ? a : std::min(a, b), to = is_closed ? b : std::max(a, b);
      const Point p = arc.point_at(from), q = arc.point_at(to);
      double sampled = 0;
      const double length = arc.length_between(from, to);
      for (int i = 0; i <= 2000; ++i) {
        const Point x = arc.point_at(from + length * i / 2000);
        const double share = std::clamp(dot(x - p, q - p) / squared_distance(p, q), 0.0, 1.0);
        sampled = std::max(sampled, distance(x, p + share * (q - p)));
      }
      const double deviation = arc.chord_deviation(from, to);
      EXPECT_GE(deviation, sampled - 1e-9);
      EXPECT_LE(deviation, sampled + length / 2000);
    }
  }
}

TEST(Arc, CircleHasItsLengthAndSagitta) {
  const LineArc line = circle(5, 5000);
  const Arc arc(line);
  EXPECT_NEAR(arc.length(), 10 * std::numbers::pi, 1e-4);
  const double quarter = arc.length() / 4;
  EXPECT_NEAR(arc.chord_deviation(0, quarter), 5 * (1 - std::sqrt(0.5)), 1e-4);
  // The same quarter across the first point.
  EXPECT_NEAR(arc.chord_deviation(3.5 * quarter, 0.5 * quarter), 5 * (1 - std::sqrt(0.5)), 1e-4);
  EXPECT_NEAR(arc.middle(3.5 * quarter, 0.5 * quarter), 0, 1e-9);
  EXPECT_NEAR(dot(arc.direction_at(quarter), {-1, 0, 0}), 1, 1e-3);
}

}  // namespace
}  // namespace podm::test
