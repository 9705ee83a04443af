#include "geometry/predicates.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace podm {
namespace {

using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
using Five = std::array<Point, 5>;

Exact::Point_3 exact(const Point& p) { return {p.x, p.y, p.z}; }

// Points of a lattice plane and of a sphere, where the last bits of a few coordinates are changed. Nearly all
// are almost or exactly coplanar or cospherical.
class NearlyDegenerate {
 public:
  Five next(bool is_on_sphere) {
    Five points;
    const double scale = std::exp2(random_() % 41) * 1e-6, shift = random_() % 2 == 0 ? 0 : 1e3 * scale;
    for (Point& p : points) {
      p = is_on_sphere ? on_sphere() : on_plane();
      for (double* x : {&p.x, &p.y, &p.z}) {
        *x = *x * scale + shift;
        if (random_() % 8 == 0) *x = std::nextafter(*x, random_() % 2 == 0 ? -1e300 : 1e300);
      }
    }
    return points;
  }

 private:
  double digit() { return static_cast<double>(random_() % 7) - 3; }
  Point on_plane() {
    const double x = digit(), y = digit();
    return {x, y, x + 2 * y};
  }
  // Returns a point such as (3,4,0), on the sphere of radius 5.
  Point on_sphere() {
    static constexpr std::array<std::array<double, 3>, 3> kPoints{{{3, 4, 0}, {0, 5, 0}, {4, 0, 3}}};
    auto p = kPoints[random_() % kPoints.size()];
    std::shuffle(p.begin(), p.end(), random_);
    for (double& x : p) x *= random_() % 2 == 0 ? -1 : 1;
    return {p[0], p[1], p[2]};
  }

  std::mt19937_64 random_{17};
};

TEST(Predicates, OrientationIsTheSignOfTheExactDeterminant) {
  NearlyDegenerate points;
  std::array<int, 3> count{};
  for (int n = 0; n < 20'000; ++n) {
    const auto [a, b, c, d, p] = points.next(n % 2 == 0);
    const int sign = orientation(a, b, c, d);
    ASSERT_EQ(sign, CGAL::orientation(exact(a), exact(b), exact(c), exact(d)));
    ++count[static_cast<std::size_t>(sign + 1)];
  }
  for (const int of_sign : count) EXPECT_GT(of_sign, 100);
}

// Four points with one coordinate in common. The other coordinates are random, or those of a lattice, where
// three points are often collinear.
class InPlaneOfAxes {
 public:
  std::array<Point, 4> next(double Point::*normal) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const double scale = std::exp2(random_() % 41) * 1e-6;
    const bool is_lattice = random_() % 2 == 0;
    const double height = random_() % 4 == 0 ? 0 : scale * uniform(random_);
    std::array<Point, 4> points;
    for (Point& p : points) {
      for (double* x : {&p.x, &p.y, &p.z})
        *x = scale * (is_lattice ? static_cast<double>(random_() % 4) : uniform(random_));
      p.*normal = height == 0 && random_() % 2 == 0 ? -0.0 : height;
    }
    return points;
  }

 private:
  std::mt19937_64 random_{29};
};

constexpr std::array kCoordinates{&Point::x, &Point::y, &Point::z};

TEST(Predicates, OrientationInAPlaneOfTheAxesIsZeroInAnyOrder) {
  InPlaneOfAxes points;
  for (int n = 0; n < 3'000; ++n) {
    const std::array<Point, 4> p = points.next(kCoordinates[n % 3u]);
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    do {
      ASSERT_EQ(orientation(p[order[0]], p[order[1]], p[order[2]], p[order[3]]), 0) << n;
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

// One of the points leaves the plane by the last bit of its coordinate.
TEST(Predicates, OrientationBesideAPlaneOfTheAxesIsTheExactSign) {
  InPlaneOfAxes points;
  std::array<int, 3> count{};
  for (unsigned n = 0; n < 6'000; ++n) {
    const auto normal = kCoordinates[n % 3];
    std::array<Point, 4> p = points.next(normal);
    double& height = p[n / 3 % 4].*normal;
    height = std::nextafter(height, n % 2 == 0 ? -1e300 : 1e300);
    const int sign = orientation(p[0], p[1], p[2], p[3]);
    ASSERT_EQ(sign, CGAL::orientation(exact(p[0]), exact(p[1]), exact(p[2]), exact(p[3]))) << n;
    ++count[static_cast<std::size_t>(sign + 1)];
  }
  for (const int of_sign : count) EXPECT_GT(of_sign, 100);
}

TEST(Predicates, PointsInSpheresAreThoseOfTheExactPower) {
  NearlyDegenerate points;
  std::array<int, 3> count{};
  for (int n = 0; n < 20'000; ++n) {
    auto [a, b, c, d, p] = points.next(n % 4 != 0);
    const int sign = orientation(a, b, c, d);
    if (sign == 0) continue;
    if (sign < 0) std::swap(a, b);
    const CGAL::Oriented_side side =
        CGAL::side_of_oriented_sphere(exact(a), exact(b), exact(c), exact(d), exact(p));
    ++count[static_cast<std::size_t>(side + 1)];
    if (side != CGAL::ON_ORIENTED_BOUNDARY) {
      ASSERT_EQ(in_circumsphere(a, b, c, d, p), side == CGAL::ON_POSITIVE_SIDE);
    }
  }
  for (const int of_side : count) EXPECT_GT(of_side, 100);
}

// The perturbed heights of five cospherical points have a single Delaunay triangulation. The tests from both
// cells must agree on it.
TEST(Predicates, CosphericalPointsAreDistinguishedAlikeFromAllSides) {
  NearlyDegenerate points;
  int num_cospherical = 0;
  for (int n = 0; n < 40'000; ++n) {
    const auto [a, b, c, d, p] = points.next(true);
    if (orientation(a, b, c, d) <= 0 || orientation(p, b, d, c) <= 0)
      continue;  // keeps p beyond the facet of b, c and d
    if (CGAL::side_of_oriented_sphere(exact(a), exact(b), exact(c), exact(d), exact(p)) !=
        CGAL::ON_ORIENTED_BOUNDARY)
      continue;
    ++num_cospherical;
    ASSERT_EQ(in_circumsphere(a, b, c, d, p), in_circumsphere(p, b, d, c, a));
  }
  EXPECT_GT(num_cospherical, 100);
}

}  // namespace
}  // namespace podm
