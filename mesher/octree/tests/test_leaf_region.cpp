#include <gtest/gtest.h>

#include "octree/leaf_region.h"
#include "random_octrees.h"

namespace podm::test {
namespace {

class LeafRegionOfSeed : public testing::TestWithParam<int> {
 protected:
  LeafRegionOfSeed() {
    for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf) regions.emplace_back(octree, leaf);
  }
  RandomOctree seeded{static_cast<std::uint64_t>(GetParam())};
  Octree octree = seeded.pruned();
  std::vector<LeafRegion> regions;
};

TEST_P(LeafRegionOfSeed, HasThePointsOfTheCubesThatTouchTheLeaf) {
  for (int i = 0; i < 300; ++i) {
    const Point p = seeded.point();
    for (const LeafRegion& region : regions)
      EXPECT_EQ(region.contains(p), octree.is_in_region(region.leaf(), octree.to_grid(p)));
  }
}

TEST_P(LeafRegionOfSeed, HasTheLeafAndItsFirstRing) {
  for (int i = 0; i < 300; ++i) {
    const Point p = seeded.point();
    const LeafId leaf = octree.leaf_at(p);
    if (leaf == kNoLeaf) continue;
    EXPECT_TRUE(regions[leaf].contains(p));
    for (const LeafId other : octree.first_ring(leaf)) EXPECT_TRUE(regions[other].contains(p));
  }
}

TEST_P(LeafRegionOfSeed, IsDisjointFromThoseNotWithinTwoRings) {
  std::vector<std::vector<LeafId>> rings;
  for (const LeafRegion& region : regions) {
    std::vector<LeafId>& ring = rings.emplace_back(octree.second_ring(region.leaf()));
    const std::vector<LeafId> first = octree.first_ring(region.leaf());
    ring.insert(ring.end(), first.begin(), first.end());
    ring.push_back(region.leaf());
    std::sort(ring.begin(), ring.end());
  }
  for (int i = 0; i < 300; ++i) {
    const Point p = seeded.point();
    std::vector<LeafId> with_p;
    for (const LeafRegion& region : regions)
      if (region.contains(p)) with_p.push_back(region.leaf());
    for (const LeafId leaf : with_p)
      EXPECT_TRUE(std::includes(rings[leaf].begin(), rings[leaf].end(), with_p.begin(), with_p.end()));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, LeafRegionOfSeed, testing::Range(0, kNumSeeds));

// Operations in a leaf, at their farthest or at random, for cells within the bounds of leaf_side().
class Reach {
 public:
  Reach(double radius_mm, double delta_mm) : radius_mm_(radius_mm), delta_mm_(delta_mm) {}

  /// Returns a vertex that an operation for a cell with this circumcenter may lock.
  Point locked_vertex(const Point& circumcenter) {
    Point p = circumcenter;
    const auto rule = random_() % 3;
    if (rule == 1) p = near(p, radius_mm_);                           // R1, R2
    if (rule == 2) p = near(near(p, radius_mm_), radius_mm_);         // R3: through a vertex of the cell
    if (rule != 0 && random_() % 2 == 0) p = near(p, 2 * delta_mm_);  // R6
    return near(near(p, radius_mm_), radius_mm_);  // through the center of a cell with p in its ball
  }

 private:
  Point near(const Point& p, double distance_mm) {
    std::normal_distribution<double> normal;
    Vector d{normal(random_), normal(random_), normal(random_)};
    if (random_() % 4 == 0) d = {1, 0, 0};
    if (random_() % 4 == 0) distance_mm *= std::uniform_real_distribution(0.0, 1.0)(random_);
    return p + distance_mm / std::sqrt(squared_length(d)) * d;
  }

  double radius_mm_, delta_mm_;
  std::mt19937_64 random_{11};
};

TEST(LeafSide, KeepsOperationsInTheirRegion) {
  const double delta_mm = 0.7;
  for (const double initial_radius_mm : {0.5, 2.0, 8.0}) {
    // Slightly more than needed, for rounding.
    const double side_mm = leaf_side(initial_radius_mm, delta_mm) * (1 + 1e-9);
    const auto constant = [&](const Point&, const Point&) { return side_mm; };
    const Octree octree({0, 0, 0}, {5 * side_mm, 5 * side_mm, 5 * side_mm}, side_mm, constant,
                        [](const Point&, const Point&) { return true; });
    const double middle = 2.5 * side_mm;
    const LeafRegion region(octree, octree.leaf_at({middle, middle, middle}));
    Reach reach(initial_radius_mm + 2 * delta_mm, delta_mm);
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> coordinate(2 * side_mm, 3 * side_mm);
    bool has_neared_the_end = false;
    for (int i = 0; i < 200'000; ++i) {
      Point c{coordinate(random), coordinate(random), coordinate(random)};
      if (i % 2 == 0) c.x = 3 * side_mm * (1 - 1e-12);
      const Point vertex = reach.locked_vertex(c);
      ASSERT_TRUE(region.contains(vertex)) << vertex.x << " " << vertex.y << " " << vertex.z;
      has_neared_the_end = has_neared_the_end || vertex.x > 4 * side_mm * (1 - 1e-6);
    }
    EXPECT_TRUE(has_neared_the_end);  // no smaller side would suffice for these operations
  }
}

}  // namespace
}  // namespace podm::test
