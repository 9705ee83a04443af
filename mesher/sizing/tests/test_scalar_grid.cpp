// Numbers between nodes: functions that are linear along each axis are reproduced, nodes without a number are
// left out, and at a jump the least number is taken.
#include "sizing/scalar_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace podm {
namespace {

constexpr Affine kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

ScalarGrid grid_of(const std::array<int, 3>& size, std::vector<float> values,
                   const Affine& to_nodes = kIdentity) {
  return {size, to_nodes, std::make_shared<const std::vector<float>>(std::move(values))};
}

TEST(ScalarGrid, KeepsAFunctionThatIsLinearAlongEachAxis) {
  const auto f = [](const Point& p) { return 5 + 0.5 * p.x - 0.25 * p.y + p.z + 0.125 * p.x * p.y * p.z; };
  std::vector<float> values;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i) values.push_back(static_cast<float>(f({1.0 * i, 1.0 * j, 1.0 * k})));
  const ScalarGrid grid = grid_of({5, 4, 3}, values);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(0, 4), y(0, 3), z(0, 2);
  for (int n = 0; n < 1000; ++n) {
    const Point p{x(random), y(random), z(random)};
    EXPECT_NEAR(grid.at(p), f(p), 1e-12);
  }
}

TEST(ScalarGrid, IsConstantToTheBitWhereNodesAre) {
  const float value = 0.7F;
  const ScalarGrid grid = grid_of({3, 3, 3}, std::vector<float>(27, value));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-0.5, 2.5);
  for (int n = 0; n < 1000; ++n) EXPECT_EQ(grid.at({any(random), any(random), any(random)}), value);
}

TEST(ScalarGrid, ReachesHalfACellBeyondItsNodes) {
  const ScalarGrid grid = grid_of({2, 1, 1}, {1, 3});
  EXPECT_EQ(grid.at({-0.5, 0, 0}), 1);
  EXPECT_EQ(grid.at({1.5, 0.5, -0.5}), 3);
  EXPECT_EQ(grid.at({0.25, 0.4, 0.4}), 1.5);
  EXPECT_EQ(grid.at({-0.51, 0, 0}), ScalarGrid::kNone);
  EXPECT_EQ(grid.at({0, 0.51, 0}), ScalarGrid::kNone);
  EXPECT_EQ(grid.at({std::nan(""), 0, 0}), ScalarGrid::kNone);
}

TEST(ScalarGrid, GoesOnAsAtItsBorderWhereThatIsAskedFor) {
  const ScalarGrid grid = grid_of({2, 1, 1}, {1, 3});
  EXPECT_EQ(grid.at_nearest({-20, 7, -3}), 1);
  EXPECT_EQ(grid.at_nearest({1e9, 0, 0}), 3);
  EXPECT_EQ(grid.at_nearest({0.25, -40, 0.4}), 1.5);
  EXPECT_EQ(grid.at_nearest({std::nan(""), 0, 0}), ScalarGrid::kNone);
  EXPECT_EQ(grid.at_nearest({0, std::numeric_limits<double>::infinity(), 0}), ScalarGrid::kNone);
}

TEST(ScalarGrid, LeavesOutNodesWithoutANumber) {
  const ScalarGrid grid = grid_of({2, 2, 1}, {2, 0, 4, 0});
  EXPECT_DOUBLE_EQ(grid.at({0.9, 0.5, 0}), 3) << "of the two that have one";
  EXPECT_DOUBLE_EQ(grid.at({0.25, 0.75, 0}), 3.5);
  EXPECT_EQ(grid.at({1.2, 0.5, 0}), ScalarGrid::kNone) << "beyond the nodes that have one";
  EXPECT_EQ(grid_of({2, 2, 1}, {0, 0, 0, 0}).at({0.5, 0.5, 0}), ScalarGrid::kNone);
}

TEST(ScalarGrid, IsTheLeastOfBothSidesAtAJump) {
  const ScalarGrid grid = grid_of({4, 1, 1}, {2, 0, 0, 5});
  for (const double step : {-1e-9, 0.0, 1e-9}) {
    EXPECT_EQ(grid.at({1 + step, 0, 0}), 2);
    EXPECT_EQ(grid.at({2 + step, 0, 0}), 5);
  }
  EXPECT_EQ(grid.at({1.5, 0, 0}), ScalarGrid::kNone);
  const ScalarGrid jump = grid_of({3, 1, 1}, {2, 0, 5});
  for (const double step : {-1e-9, 0.0, 1e-9}) EXPECT_EQ(jump.at({1 + step, 0, 0}), 2);
  EXPECT_EQ(jump.at({1.1, 0, 0}), 5);
}

TEST(ScalarGrid, FindsTheRangeInABoxAndWhetherTheyMeet) {
  std::vector<float> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 10);  // 0 to 9 along x
  const ScalarGrid grid = grid_of({10, 10, 10}, values, {0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0});  // 2 mm
  const auto range = grid.range_in({{9, 2, 2}, {11, 4, 4}});
  EXPECT_LE(range.least, 4);
  EXPECT_GE(range.least, 3) << "one node more than has a weight";
  EXPECT_GE(range.most, 6);
  EXPECT_LE(range.most, 7);
  EXPECT_EQ(grid.range_in({{-9, 2, 2}, {-1, 4, 4}}).least, 1) << "0 is none";
  EXPECT_TRUE(grid.meets({{18.9, 0, 0}, {30, 5, 5}}));
  EXPECT_FALSE(grid.meets({{19.1, 0, 0}, {30, 5, 5}}));
  EXPECT_FALSE(grid.meets({{0, 0, -9}, {5, 5, -1.1}}));
}

TEST(ScalarGrid, MeetsNoBoxBesideAGridThatIsTurned) {
  const double r = std::sqrt(0.5);  // by 45 degrees about z
  const ScalarGrid grid =
      grid_of({10, 10, 10}, std::vector<float>(1000, 1), {r, r, 0, 0, -r, r, 0, 0, 0, 0, 1, 0});
  EXPECT_TRUE(grid.meets({{-1, 5, 0}, {1, 7, 1}}));
  EXPECT_FALSE(grid.meets({{5, 0, 0}, {7, 1, 1}})) << "within the bounds of the turned grid";
}

}  // namespace
}  // namespace podm
