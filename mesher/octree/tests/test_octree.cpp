#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "octree/octree.h"
#include "podm/errors.h"
#include "random_octrees.h"

namespace podm::test {
namespace {

using Ids = std::vector<LeafId>;

bool always(const Point&, const Point&) { return true; }

bool interiors_meet(const GridCube& a, const GridCube& b) {
  for (unsigned axis = 0; axis < 3; ++axis)
    if (a.corner[axis] >= b.corner[axis] + b.side || b.corner[axis] >= a.corner[axis] + a.side) return false;
  return true;
}

std::uint64_t volume_in_grid(const GridCube& cube, const GridPoint& size) {
  std::uint64_t volume = 1;
  for (unsigned axis = 0; axis < 3; ++axis)
    volume *= std::min(cube.corner[axis] + cube.side, size[axis]) - cube.corner[axis];
  return volume;
}

GridCube around(const GridCube& cube, std::uint32_t side) {
  GridCube parent{cube.corner, side};
  for (auto& x : parent.corner) x -= x % side;
  return parent;
}

// Returns the leaf that owns the grid coordinates g, computed from the definition.
LeafId owner_of(const Octree& octree, const Point& g) {
  const double coordinates[] = {g.x, g.y, g.z};
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf) {
    const GridCube& cube = octree.cube(leaf);
    bool is_inside = true;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const std::uint32_t end = cube.corner[axis] + cube.side, size = octree.grid_size()[axis];
      const double x = coordinates[axis];
      is_inside = is_inside && x >= cube.corner[axis] && x <= size && (x < end || end >= size);
    }
    if (is_inside) return leaf;
  }
  return kNoLeaf;
}

class OctreeOfSeed : public testing::TestWithParam<int> {
 protected:
  RandomOctree seeded{static_cast<std::uint64_t>(GetParam())};
  Octree whole = seeded.whole(), pruned = seeded.pruned();
};

TEST_P(OctreeOfSeed, CubesTileTheBox) {
  const std::vector<GridCube> cubes = cubes_of(whole);
  std::uint64_t volume = 0;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    volume += volume_in_grid(cubes[i], whole.grid_size());
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(interiors_meet(cubes[i], cubes[j]));
  }
  const GridPoint& size = whole.grid_size();
  EXPECT_EQ(volume, std::uint64_t{size[0]} * size[1] * size[2]);
}

TEST_P(OctreeOfSeed, LeavesAreTheNeededCubesInMortonOrder) {
  std::vector<GridCube> needed;
  for (const GridCube& cube : cubes_of(whole))
    if (seeded.is_needed(corner_mm(whole, cube, 0), corner_mm(whole, cube, cube.side)))
      needed.push_back(cube);
  EXPECT_EQ(cubes_of(pruned), needed);
  for (LeafId leaf = 0; leaf < whole.num_leaves(); ++leaf) {
    const GridCube& cube = whole.cube(leaf);
    EXPECT_TRUE(std::has_single_bit(cube.side));
    for (const std::uint32_t x : cube.corner) EXPECT_EQ(x % cube.side, 0u);
    EXPECT_TRUE(leaf == 0 || morton_code(whole.cube(leaf - 1).corner) < morton_code(cube.corner));
  }
}

// Cubes are balanced, no larger than requested, and no smaller than these two conditions demand.
TEST_P(OctreeOfSeed, SidesAreTheLargestAllowed) {
  const std::vector<GridCube> cubes = cubes_of(whole);
  const auto is_too_large = [&](const GridCube& cube) {
    const Point low = corner_mm(whole, cube, 0), high = corner_mm(whole, cube, cube.side);
    return cube.side > 1 && cube.side * whole.finest_side_mm() > seeded.largest_side(low, high);
  };
  for (const GridCube& a : cubes) {
    EXPECT_FALSE(is_too_large(a));
    const GridCube parent = around(a, 2 * a.side);
    bool has_to_be_split = is_too_large(parent);
    for (const GridCube& b : cubes) {
      EXPECT_TRUE(!touch(a, b) || a.side <= 2 * b.side);
      has_to_be_split = has_to_be_split || (b.side < a.side && touch(around(b, a.side), parent));
    }
    EXPECT_TRUE(has_to_be_split || cubes.size() == 1);
    EXPECT_TRUE(seeded.is_graded || a.side == 1);
  }
}

TEST_P(OctreeOfSeed, LeafAtFindsTheLeafThatHasThePoint) {
  for (int i = 0; i < 1000; ++i) {
    const Point p = seeded.point();
    EXPECT_EQ(pruned.leaf_at(p), owner_of(pruned, pruned.to_grid(p)));
  }
  EXPECT_EQ(whole.leaf_at(seeded.low), 0u);
  EXPECT_NE(whole.leaf_at(0.5 * (seeded.low + seeded.high)), kNoLeaf);
}

TEST_P(OctreeOfSeed, RingsAreTheLeavesThatTouchAndThoseBeyondWithRegionsThatMeet) {
  const std::vector<GridCube> cubes = cubes_of(whole);
  for (int i = 0; i < 20 && pruned.num_leaves() > 0; ++i) {
    const LeafId leaf = static_cast<LeafId>(seeded.random() % pruned.num_leaves());
    Ids first, second;
    for (LeafId other = 0; other < pruned.num_leaves(); ++other) {
      if (other == leaf) continue;
      if (touch(pruned.cube(leaf), pruned.cube(other)))
        first.push_back(other);
      else if (is_within_two_rings(cubes, pruned.cube(leaf), pruned.cube(other)))
        second.push_back(other);
    }
    EXPECT_EQ(pruned.first_ring(leaf), first);
    EXPECT_EQ(pruned.second_ring(leaf), second);
  }
}

TEST_P(OctreeOfSeed, AfterAStopRequestNothingIsAskedAndEveryPointIsSomewhere) {
  std::size_t asked = 0;
  const auto make = [&](std::size_t calls_before_stop) {
    std::stop_source stop;
    asked = 0;
    const auto ask = [&] { ++asked == calls_before_stop&& stop.request_stop(); };
    return Octree(
        seeded.low, seeded.high, seeded.finest_side_mm(),
        [&](const Point& low, const Point& high) { return ask(), seeded.largest_side(low, high); },
        [&](const Point& low, const Point& high) { return ask(), seeded.is_needed(low, high); },
        stop.get_token());
  };
  EXPECT_EQ(cubes_of(make(0)), cubes_of(pruned));
  const std::size_t calls = asked;
  for (std::size_t last = 1; last <= calls; last += 1 + last / 4) {
    const Octree stopped = make(last);
    EXPECT_EQ(asked, last);
    EXPECT_LE(stopped.num_leaves(), pruned.num_leaves());
    for (int i = 0; i < 20; ++i) {
      const Point p = seeded.point();
      EXPECT_EQ(stopped.leaf_at(p), owner_of(stopped, stopped.to_grid(p)));
    }
  }
}

TEST_P(OctreeOfSeed, RingsAreSymmetric) {
  std::vector<Ids> first, second;
  for (LeafId leaf = 0; leaf < pruned.num_leaves(); ++leaf) {
    first.push_back(pruned.first_ring(leaf));
    second.push_back(pruned.second_ring(leaf));
  }
  for (const auto& rings : {first, second})
    for (LeafId leaf = 0; leaf < rings.size(); ++leaf)
      for (const LeafId other : rings[leaf])
        EXPECT_TRUE(std::binary_search(rings[other].begin(), rings[other].end(), leaf));
}

INSTANTIATE_TEST_SUITE_P(Seeds, OctreeOfSeed, testing::Range(0, kNumSeeds));

TEST(Octree, CubesOwnTheirLowFacesAndTheBoxItsHighOnes) {
  const auto constant = [](const Point&, const Point&) { return 0.5; };
  const Octree octree({-1, 0, 2}, {0, 1, 3}, 0.5, constant, always);
  ASSERT_EQ(octree.num_leaves(), 8u);
  EXPECT_EQ(octree.leaf_at({-1, 0, 2}), 0u);
  EXPECT_EQ(octree.leaf_at({-0.5, 0, 2}), 1u);
  EXPECT_EQ(octree.leaf_at({-0.5, 0.5, 2.5}), 7u);
  EXPECT_EQ(octree.leaf_at({0, 1, 3}), 7u);
  EXPECT_EQ(octree.leaf_at({std::nextafter(-0.5, -1), 0, 2}), 0u);
  EXPECT_EQ(octree.leaf_at({-1.25, 0, 2}), kNoLeaf);
  EXPECT_EQ(octree.leaf_at({0, 1.25, 3}), kNoLeaf);
  EXPECT_EQ(octree.leaf_at({std::numeric_limits<double>::quiet_NaN(), 0, 2}), kNoLeaf);
  EXPECT_EQ(octree.leaf_at({0, 0, std::numeric_limits<double>::infinity()}), kNoLeaf);
}

TEST(Octree, FinestGridsTooLargeForATableAreSearched) {
  const Point corner{1, 2, 3};
  const auto side = [&](const Point& low, const Point&) { return 0.3 * distance(low, corner); };
  const Octree octree(corner, {513, 514, 515}, 0.25, side, always);
  ASSERT_GT(octree.grid_size()[0], 1000u);
  std::mt19937_64 random(7);
  for (int i = 0; i < 3000; ++i) {
    const double scale = std::exp2(-static_cast<double>(random() % 12));
    std::uniform_real_distribution<double> offset(0, 512 * scale);
    const Point p = corner + Vector{offset(random), offset(random), offset(random)};
    EXPECT_EQ(octree.leaf_at(p), owner_of(octree, octree.to_grid(p)));
  }
}

TEST(Octree, DegenerateBoxes) {
  const auto constant = [](const Point&, const Point&) { return 1.0; };
  const Octree point({1, 1, 1}, {1, 1, 1}, 1, constant, always);
  EXPECT_EQ(point.num_leaves(), 1u);
  EXPECT_EQ(point.leaf_at({1, 1, 1}), 0u);
  EXPECT_TRUE(point.first_ring(0).empty());
  EXPECT_TRUE(point.second_ring(0).empty());
  const Octree flat({0, 0, 0}, {5, 5, 0}, 1, constant, always);
  EXPECT_EQ(flat.num_leaves(), 25u);
  EXPECT_EQ(flat.first_ring(flat.leaf_at({2.5, 2.5, 0})).size(), 8u);
  EXPECT_EQ(flat.second_ring(flat.leaf_at({2.5, 2.5, 0})).size(), 16u);
  const Octree none({0, 0, 0}, {5, 5, 5}, 1, constant, [](const Point&, const Point&) { return false; });
  EXPECT_EQ(none.num_leaves(), 0u);
  EXPECT_EQ(none.leaf_at({2, 2, 2}), kNoLeaf);
}

TEST(Octree, GapsKeepLeavesApart) {
  const auto constant = [](const Point&, const Point&) { return 1.0; };
  const Octree octree({0, 0, 0}, {7, 1, 1}, 1, constant, [](const Point& low, const Point&) {
    return low.x == 0 || low.x == 2 || low.x == 3 || low.x == 6;
  });
  EXPECT_EQ(octree.first_ring(0), Ids{});
  EXPECT_EQ(octree.second_ring(0), Ids{1});
  EXPECT_EQ(octree.first_ring(1), Ids{2});
  EXPECT_EQ(octree.second_ring(1), Ids{0});
  EXPECT_EQ(octree.second_ring(3), Ids{});
}

TEST(Octree, RefusesSidesThatMakeNoGrid) {
  const auto constant = [](const Point&, const Point&) { return 1.0; };
  const auto make = [&](const Point& high, double side_mm) {
    return Octree({0, 0, 0}, high, side_mm, constant, always);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double side_mm : {0.0, -1.0, 1e-7, nan}) EXPECT_THROW(make({1, 1, 1}, side_mm), InputError);
  for (const Point high : {Point{-1, 1, 1}, Point{1, nan, 1}, Point{1, 1, 1e300}})
    EXPECT_THROW(make(high, 1), InputError);
}

}  // namespace
}  // namespace podm::test
