// The filter on stored spheres: each decision of the filter equals that of the exact predicate.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/circumsphere.h"
#include "point_sets.h"

namespace podm::test {
namespace {

struct PositiveCell {
  std::array<Point, 4> p;
  Circumsphere sphere;
  float stored = 0;
};

// Returns cells of the given size at random places. Some are flat and therefore not certified.
std::vector<PositiveCell> random_cells(double size) {
  std::vector<PositiveCell> cells;
  std::mt19937_64 random(7);
  for (const Point& center : random_points(1, 200, 20 * size)) {
    std::vector<Point> p = random_points(static_cast<unsigned>(random()), 4, size, center);
    if (cells.size() % 8 == 0) p[3] = p[0] + 0.5 * (p[1] - p[0]) + 1e-9 * (p[3] - p[0]);
    const int turn = orientation(p[0], p[1], p[2], p[3]);
    if (turn == 0) continue;
    if (turn < 0) std::swap(p[0], p[1]);
    const Circumsphere sphere = circumsphere(p[0], p[1], p[2], p[3], 21 * size);
    cells.push_back({{p[0], p[1], p[2], p[3]}, sphere, stored_squared_radius(sphere.squared_radius)});
  }
  return cells;
}

// Returns a point at (1 + relative) radii from the center.
Point beside_sphere(const PositiveCell& cell, const Vector& direction, double relative) {
  const double radius = distance(cell.sphere.center, cell.p[3]);
  return cell.sphere.center + ((1 + relative) * radius / std::sqrt(squared_length(direction))) * direction;
}

class StoredSpheres : public testing::TestWithParam<double> {};

TEST_P(StoredSpheres, DecideAsTheExactPredicateDoes) {
  int decided = 0, undecided = 0;
  for (const PositiveCell& cell : random_cells(GetParam())) {
    const auto& p = cell.p;
    for (const Vector& direction : random_points(3, 5, 1)) {
      for (const int exponent : {-2, -19, -20, -21, -22, -24, -30}) {
        for (const double relative : {std::ldexp(1.0, exponent), -std::ldexp(1.0, exponent)}) {
          const Point x = beside_sphere(cell, direction, relative);
          const Side side = side_of(cell.sphere.center, cell.stored, x);
          (side == Side::kUndecided ? undecided : decided) += 1;
          if (side == Side::kUndecided) continue;
          ASSERT_EQ(side == Side::kInside, in_circumsphere(p[0], p[1], p[2], p[3], x)) << relative;
          ASSERT_EQ(side, side_of(cell.sphere, x)) << "what r^2 itself leaves undecided is decided";
        }
      }
    }
  }
  EXPECT_GT(decided, 0);
  EXPECT_GT(undecided, 0);
}

// The squared radii of the largest and the smallest size are still normal floats.
INSTANTIATE_TEST_SUITE_P(Sizes, StoredSpheres, testing::Values(1e-17, 1e-3, 1.0, 1e5, 1e17));

TEST(StoredSpheresEdge, LeaveEveryPointUndecidedBeyondNormalFloats) {
  for (const double size : {1e-35, 1e25}) {
    for (const PositiveCell& cell : random_cells(size)) {
      EXPECT_TRUE(std::isnan(cell.stored));
      for (const double relative : {-0.9, 0.0, 9.0})
        EXPECT_EQ(side_of(cell.sphere.center, cell.stored, beside_sphere(cell, {1, 2, 3}, relative)),
                  Side::kUndecided);
    }
  }
  EXPECT_TRUE(std::isnan(stored_squared_radius(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace podm::test
