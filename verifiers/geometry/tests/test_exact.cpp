#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claims/tests/small_meshes.h"

namespace podm::verify {
namespace {

// Returns lattice points at a scale, moved by a few ulps: rounding gets their signs wrong.
std::vector<Point> near_degenerate_points(std::size_t count, double scale, std::mt19937& random) {
  auto points = lattice_points(count, 3, random);
  for (Point& p : points)
    for (double& x : p) {
      x = (x + 0.1) * scale;
      for (auto steps = random() % 3; steps > 0; --steps) x = std::nextafter(x, 10 * scale);
    }
  return points;
}

constexpr double kScales[] = {0x1p-1074, 1e-310, 1e-150, 1e-60, 1, 1e60, 1e150, 1e300};

TEST(Exact, OrientationIsTheRationalOne) {
  std::mt19937 random(1);
  std::uint64_t num_exact = 0;
  for (const double scale : kScales)
    for (int round = 0; round < 500; ++round) {
      const auto p = near_degenerate_points(4, scale, random);
      EXPECT_EQ(orientation(p[0], p[1], p[2], p[3], num_exact), rational_orientation(p[0], p[1], p[2], p[3]))
          << scale;
    }
  EXPECT_GT(num_exact, 0);
}

TEST(Exact, SideOfSphereIsTheRationalOne) {
  std::mt19937 random(2);
  std::uint64_t num_exact = 0;
  for (const double scale : kScales)
    for (int round = 0; round < 500; ++round) {
      const auto p = near_degenerate_points(5, scale, random);
      if (rational_orientation(p[0], p[1], p[2], p[3]) == 0) continue;
      EXPECT_EQ(side_of_sphere(p[0], p[1], p[2], p[3], p[4], num_exact),
                rational_side_of_sphere({p[0], p[1], p[2], p[3]}, p[4]))
          << scale;
    }
  EXPECT_GT(num_exact, 0);
}

TEST(Exact, FilterDecidesClearCases) {
  std::mt19937 random(3);
  std::uint64_t num_exact = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto p = random_points(5, random);
    if (orientation(p[0], p[1], p[2], p[3], num_exact) != 0)
      side_of_sphere(p[0], p[1], p[2], p[3], p[4], num_exact);
  }
  EXPECT_LE(num_exact, 1);
}

TEST(Exact, SignOfDistinguishesZeroFromTiny) {
  std::uint64_t num_exact = 0;
  const auto third = [](double x) { return [x]<class T>(T) { return T(x) * T(3) - T(1); }; };
  EXPECT_EQ(sign_of(third(1. / 3), num_exact), -1);  // 1/3 is rounded down
  EXPECT_EQ(sign_of(third(std::nextafter(1. / 3, 1)), num_exact), 1);
  const auto cancelling = [](double tiny) { return [tiny]<class T>(T) { return (T(1) + T(tiny)) - T(1); }; };
  num_exact = 0;
  EXPECT_EQ(sign_of(cancelling(1e-300), num_exact), 1);
  EXPECT_EQ(sign_of(cancelling(-1e-300), num_exact), -1);
  EXPECT_EQ(num_exact, 2);
  EXPECT_EQ(sign_of(cancelling(0), num_exact), 0);
}

TEST(Exact, DecimalAsTypedIsTheShortestThatReadsBack) {
  EXPECT_EQ(decimal_as_typed(1.93), Rational(193, 100));
  EXPECT_EQ(decimal_as_typed(30), Rational(30));
  EXPECT_EQ(decimal_as_typed(1e-7), Rational(1, 10000000));
  EXPECT_EQ(decimal_as_typed(-2.5e20), Rational(-25) * decimal_as_typed(1e19));
  EXPECT_EQ(decimal_as_typed(0), Rational(0));
}

TEST(Exact, SquaredSineIsExactOrJustAbove) {
  EXPECT_EQ(squared_sine(30), Rational(1, 4));
  EXPECT_EQ(squared_sine(45), Rational(1, 2));
  EXPECT_EQ(squared_sine(60), Rational(3, 4));
  for (double degrees = 0.25; degrees < 90; degrees += 0.375)
    EXPECT_NEAR(CGAL::to_double(squared_sine(degrees)),
                std::pow(std::sin(degrees * std::numbers::pi / 180), 2), 1e-14);
  // sin^2 of 18 degrees is (3 - sqrt 5) / 8.
  Rational gap(1);
  for (int i = 0; i < 70; ++i) gap = gap / Rational(10);
  const auto root = [](const Rational& s) { return Rational(3) - Rational(8) * s; };
  const Rational above = squared_sine(18), below = above - gap;
  EXPECT_LT(root(above) * root(above), Rational(5));
  EXPECT_GT(root(below) * root(below), Rational(5));
}

}  // namespace
}  // namespace podm::verify
