// Compares searches in the tree of surface voxels with a linear search, on random grids of 2 to 80 voxels per
// side.
#include "isosurface/surface_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <vector>

namespace podm::test {
namespace {

class RandomTree : public testing::TestWithParam<unsigned> {
 protected:
  RandomTree() : random_(GetParam()) {
    std::array<int, 3> size;
    for (std::size_t a = 0; a < 3; ++a) {
      size[a] = std::uniform_int_distribution(2, 80)(random_);
      spacing_[a] = std::uniform_real_distribution(0.3, 4.0)(random_);
    }
    const BrickGrid bricks(size);
    masks_.resize(bricks.count());
    const auto count = 1 << std::uniform_int_distribution(0, 9)(random_);
    for (int n = 0; n < count; ++n) {
      const Voxel v{random_below(size[0]), random_below(size[1]), random_below(size[2])};
      masks_[bricks.index_of_voxel(v)] |= std::uint64_t{1} << place_in_brick(v);
      surface_.push_back(v);
    }
    bricks_ = bricks;
    size_ = size;
    tree_ = SurfaceTree(bricks, masks_, spacing_);
  }

  int random_below(int n) { return std::uniform_int_distribution(0, n - 1)(random_); }
  // A point on the lattice, where distances are equal, or off it. It lies in the grid or up to its length
  // outside.
  Point random_point() {
    std::array<double, 3> u;
    for (std::size_t a = 0; a < 3; ++a) u[a] = std::uniform_real_distribution(-1.0, 2.0)(random_) * size_[a];
    if (random_below(2) == 0)
      for (double& x : u) x = std::round(x);
    return {u[0], u[1], u[2]};
  }
  double squared_mm(const Point& u, const Voxel& v) const {
    const double x = (u.x - v.i) * spacing_[0], y = (u.y - v.j) * spacing_[1], z = (u.z - v.k) * spacing_[2];
    return x * x + y * y + z * z;
  }
  double least_squared_mm(const Point& u) const {
    double least = squared_mm(u, surface_.front());
    for (const Voxel& v : surface_) least = std::min(least, squared_mm(u, v));
    return least;
  }
  template <class Take>
  void visit(const Point& u, double squared_reach, const Take& take) const {
    const auto mask_of = [&](const Voxel& brick) { return masks_[bricks_.index(brick.i, brick.j, brick.k)]; };
    tree_.visit(u, squared_reach, mask_of,
                [&](const Voxel& v, double squared) { take(v, squared, squared_reach); });
  }

  static constexpr double kRounding = 1e-12;  // relative
  std::mt19937_64 random_;
  std::array<int, 3> size_;
  std::array<double, 3> spacing_;
  BrickGrid bricks_;
  std::vector<std::uint64_t> masks_;
  std::vector<Voxel> surface_;
  SurfaceTree tree_;
};

TEST_P(RandomTree, VisitsEachSurfaceVoxelInReachOnce) {
  for (int n = 0; n < 100; ++n) {
    const Point u = random_point();
    const double reach2 = least_squared_mm(u) * std::uniform_real_distribution(0.5, 4.0)(random_);
    std::map<std::tuple<int, int, int>, int> visits;
    visit(u, reach2, [&](const Voxel& v, double squared, double&) {
      ++visits[{v.i, v.j, v.k}];
      EXPECT_NEAR(squared, squared_mm(u, v), kRounding * squared);
      EXPECT_LE(squared, reach2);
    });
    for (const Voxel& v : surface_) {
      const double squared = squared_mm(u, v);
      if (std::fabs(squared - reach2) <= kRounding * reach2) continue;  // rounding decides
      EXPECT_EQ((visits[{v.i, v.j, v.k}]), squared < reach2 ? 1 : 0);
    }
    EXPECT_TRUE(
        std::all_of(visits.begin(), visits.end(), [](const auto& visit) { return visit.second < 2; }));
  }
}

TEST_P(RandomTree, ShrinkingTheReachLeadsToTheNearest) {
  for (int n = 0; n < 100; ++n) {
    const Point u = random_point();
    double found2 = -1;
    visit(u, 1e12, [&](const Voxel&, double squared, double& squared_reach) {
      squared_reach = squared;
      found2 = squared;
    });
    EXPECT_NEAR(found2, least_squared_mm(u), kRounding * found2);
  }
}

TEST_P(RandomTree, ANegativeReachEndsTheSearch) {
  for (int n = 0; n < 100; ++n) {
    int num_visits = 0;
    visit(random_point(), 1e12, [&](const Voxel&, double, double& squared_reach) {
      ++num_visits;
      squared_reach = -1;
    });
    EXPECT_EQ(num_visits, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomTree, testing::Range(0u, 40u));

}  // namespace
}  // namespace podm::test
