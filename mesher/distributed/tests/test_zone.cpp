// Cubes and zones of cubes give the same answers for points and balls as tests of each single cube.
#include "distributed/zone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace podm::test {
namespace {

class CubesAndZones : public testing::Test {
 protected:
  // Draws some boxes of cubes, which resemble zones more than single cubes do.
  CubeSet drawn_cubes() {
    CubeSet set(grid_);
    for (int i = 0; i < 3; ++i) {
      CubeRange box;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = draw(grid_.size()[axis]);
        box.high[axis] = box.low[axis] + 1 + draw(grid_.size()[axis] - box.low[axis]);
      }
      set.insert(box);
    }
    return set;
  }
  int draw(int bound) { return std::uniform_int_distribution(0, bound - 1)(random_); }
  double drawn_mm(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Point drawn_point() { return {drawn_mm(-8, 30), drawn_mm(-8, 25), drawn_mm(-8, 20)}; }

  std::mt19937_64 random_{1};
  const CubeGrid grid_{{{0, 0, 0}, {22, 17, 12}}, 1.7};
};

TEST_F(CubesAndZones, DepthsAreRingsOfCubesInTheSet) {
  for (int i = 0; i < 20; ++i) {
    const CubeSet set = drawn_cubes();
    const CubeDepths depths(set, grid_.all(), 5);
    CubeSet outside(grid_);
    for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
      if (!set.has(cube)) outside.insert(cube);
    for (int depth = 1; depth <= 5; ++depth) {
      const CubeSet near_outside = outside.grown(depth);
      for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
        ASSERT_EQ(depths(grid_.place_of(cube)) >= depth, !near_outside.has(cube))
            << "cube " << cube << ", depth " << depth;
    }
  }
}

TEST_F(CubesAndZones, DepthsWithinARangeAreThoseOfTheCubesThere) {
  for (int i = 0; i < 20; ++i) {
    const CubeSet set = drawn_cubes();
    const CubeRange within = drawn_cubes().range();
    CubeSet inside(grid_);
    for (const CubeId cube : set.cubes())
      if (within.has(grid_.place_of(cube))) inside.insert(cube);
    const CubeDepths depths(set, within, 5), of_those(inside, grid_.all(), 5);
    for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
      ASSERT_EQ(depths(grid_.place_of(cube)), of_those(grid_.place_of(cube))) << "cube " << cube;
  }
}

TEST_F(CubesAndZones, CubesOfAnyBoxAreThoseOfVisits) {
  for (int i = 0; i < 20; ++i) {
    CubeSet set(grid_);
    for (int cubes = draw(6) * draw(6); cubes > 0; --cubes)
      set.insert(grid_.id({3 + draw(5), 2 + draw(5), 1 + draw(4)}));
    std::set<CubeId> found;
    for (const CubeId cube : set.cubes()) found.insert(cube);
    for (int k = 0; k < 200; ++k) {
      CubeRange box;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = draw(grid_.size()[axis]);
        box.high[axis] = std::min(grid_.size()[axis], box.low[axis] + 1 + draw(4));
      }
      int visited = 0, in_set = 0;
      grid_.for_each(box, [&](CubeId cube, const CubePlace&) {
        ++visited;
        in_set += set.has(cube);
        EXPECT_EQ(set.has(cube), found.contains(cube));
      });
      EXPECT_EQ(set.meets(box), in_set > 0);
      EXPECT_EQ(set.covers(box), in_set == visited);
    }
  }
}

TEST_F(CubesAndZones, CubesAreNumberedInOrder) {
  const CubeSet set = drawn_cubes();
  const CubeNumbers number_of(set);
  std::size_t next = 0;
  for (CubeId cube = 0; cube < grid_.num_cubes(); ++cube)
    if (set.has(cube)) {
      ASSERT_EQ(number_of[cube], next++);
    }
  EXPECT_EQ(number_of.count(), next);
}

TEST_F(CubesAndZones, WhatIsWithinReachOfAPointIsInTheZone) {
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

TEST_F(CubesAndZones, InsertionsHaveRoomWhereTheBallAroundThemLiesInTheZone) {
  std::array<int, 2> count{};
  for (int i = 0; i < 20; ++i) {
    const CubeSet own = drawn_cubes();
    const Zone narrow(own, own.grown(1), 1), zone(own, own.grown(1), 1, 2);
    for (int k = 0; k < 1000; ++k) {
      const Point p = drawn_point();
      Cell cell{};
      const double radius_mm = drawn_mm(0.1, 4);
      cell.squared_radius = static_cast<float>(radius_mm * radius_mm);
      EXPECT_EQ(narrow.has_room(p, cell), own.has(p));
      const bool has_room = zone.has_room(p, cell);
      ++count[has_room];
      for (int j = 0; j < 50 && has_room; ++j) {
        const Vector v{drawn_mm(-1, 1), drawn_mm(-1, 1), drawn_mm(-1, 1)};
        EXPECT_TRUE(own.has(p + (1.99 * radius_mm / std::max(1.0, std::sqrt(squared_length(v)))) * v));
      }
      if (!has_room && own.has(p)) {
        EXPECT_FALSE(own.covers(p, 2.01 * radius_mm));
      }
      cell.squared_radius = std::numeric_limits<float>::quiet_NaN();
      EXPECT_EQ(zone.has_room(p, cell), own.has(p));
    }
  }
  EXPECT_GT(std::min(count[0], count[1]), 100);
}

// Also tests balls that just touch a cube.
TEST_F(CubesAndZones, ABallIsKnownOnceItsCubesAre) {
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

TEST_F(CubesAndZones, ACellWithoutASphereIsKnownOnceAllIs) {
  Cell cell{};
  cell.squared_radius = std::numeric_limits<float>::quiet_NaN();
  const CubeSet own = drawn_cubes();
  CubeSet known = own.grown(1);
  EXPECT_FALSE(Zone(own, known, 1).knows(cell));
  Zone::insert_ball(cell, known);
  EXPECT_TRUE(Zone(own, known, 1).knows(cell));
}

}  // namespace
}  // namespace podm::test
