// Cubes, blocks and zones of cubes say of points and balls what each cube by itself says.
#include "distributed/zone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "distributed/blocks.h"

namespace podm::test {
namespace {

class Zones : public testing::Test {
 protected:
  // Some boxes of cubes: more like zones than single cubes would be.
  CubeSet drawn_cubes() {
    CubeSet set(grid_);
    for (int i = 0; i < 3; ++i) {
      CubePlace low, high, at;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = draw(grid_.size()[axis]);
        high[axis] = low[axis] + draw(grid_.size()[axis] - low[axis]);
      }
      for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
        for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
          for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) set.insert(grid_.id(at));
    }
    return set;
  }
  int draw(int bound) { return std::uniform_int_distribution(0, bound - 1)(random_); }
  double drawn_mm(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Point drawn_point() { return {drawn_mm(-8, 30), drawn_mm(-8, 25), drawn_mm(-8, 20)}; }

  std::mt19937_64 random_{1};
  const CubeGrid grid_{{{0, 0, 0}, {22, 17, 12}}, 1.7};
};

TEST_F(Zones, DepthsAreRingsOfCubesInTheSet) {
  for (int i = 0; i < 20; ++i) {
    const CubeSet set = drawn_cubes();
    const std::vector<std::uint8_t> depths = set.depths(5);
    CubeSet outside(grid_);
    for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
      if (!set.has(cube)) outside.insert(cube);
    for (int depth = 1; depth <= 5; ++depth) {
      const CubeSet near_outside = outside.grown(depth);
      for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
        ASSERT_EQ(depths[cube] >= depth, !near_outside.has(cube)) << "cube " << cube << ", depth " << depth;
    }
  }
}

TEST_F(Zones, WhatIsWithinReachOfAPointIsInTheZone) {
  int num_within = 0;
  for (int i = 0; i < 20; ++i) {
    const CubeSet own = drawn_cubes();
    const Zone zone(own, own.grown(1), 1);
    for (int k = 0; k < 2000; ++k) {
      const Point p = drawn_point(), q = p + Vector{drawn_mm(-3, 3), drawn_mm(-3, 3), drawn_mm(-3, 3)};
      if (squared_distance(p, q) >= static_cast<double>(zone.squared_reach(p))) continue;
      EXPECT_TRUE(own.has(q));
      ++num_within;
    }
  }
  EXPECT_GT(num_within, 100);
}

// Where a ball just touches a cube, too.
TEST_F(Zones, ABallIsKnownOnceItsCubesAre) {
  for (int i = 0; i < 20; ++i) {
    const CubeSet own = drawn_cubes();
    for (int k = 0; k < 200; ++k) {
      Cell cell{};
      cell.center = drawn_point();
      const double to_side_mm = std::abs(std::remainder(cell.center.x, grid_.side_mm()));
      const double factor = 1 + drawn_mm(-2e-6, 2e-6);
      const double radius_mm = k % 2 == 0 ? drawn_mm(0.1, 8) : factor * (to_side_mm + 2 * grid_.side_mm());
      cell.squared_radius = static_cast<float>(radius_mm * radius_mm);
      CubeSet known = own.grown(1);
      Zone::insert_ball(cell, known);
      EXPECT_TRUE(Zone(own, known, 1).is_ball_known(cell));
    }
  }
}

TEST_F(Zones, ACellWithoutASphereIsKnownOnceAllIs) {
  Cell cell{};
  cell.squared_radius = std::numeric_limits<float>::quiet_NaN();
  const CubeSet own = drawn_cubes();
  CubeSet known = own.grown(1);
  EXPECT_FALSE(Zone(own, known, 1).knows(cell));
  Zone::insert_ball(cell, known);
  EXPECT_TRUE(Zone(own, known, 1).knows(cell));
}

TEST_F(Zones, BlocksInABoxAreThoseOfItsCubes) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Blocks blocks(grid_, seed, 1 + draw(9));
    EXPECT_EQ(Blocks(grid_, blocks.cuts()).ranks(), blocks.ranks());
    for (int k = 0; k < 20; ++k) {
      CubePlace low, high, at;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = draw(grid_.size()[axis]);
        high[axis] = low[axis] + draw(grid_.size()[axis] - low[axis]);
      }
      std::set<int> there;
      for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
        for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
          for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) there.insert(blocks.of(grid_.id(at)));
      EXPECT_EQ(blocks.in(low, high), std::vector<int>(there.begin(), there.end()));
    }
  }
}

}  // namespace
}  // namespace podm::test
