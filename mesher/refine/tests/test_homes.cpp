#include <gtest/gtest.h>

#include <random>

#include "refine/homes.h"

namespace podm::test {
namespace {

class HomesOfSeed : public testing::TestWithParam<unsigned> {
 protected:
  double coordinate() { return std::uniform_real_distribution(-50.0, 150.0)(random_); }
  std::vector<Homes::Work> some_work(std::size_t count) {
    std::vector<Homes::Work> work(count);
    for (Homes::Work& w : work)
      w = {{coordinate(), 0.3 * coordinate(), 2 * coordinate()},
           std::uniform_real_distribution(0.5, 1.5)(random_)};
    return work;
  }
  std::mt19937 random_{GetParam()};
  unsigned num_homes_ = 1 + static_cast<unsigned>(random_() % 40);
};

TEST_P(HomesOfSeed, HaveEqualSharesOfTheWork) {
  const std::vector<Homes::Work> work = some_work(200 * num_homes_);
  const Homes homes(work, num_homes_);
  std::vector<double> amounts(num_homes_);
  double total = 0;
  for (const Homes::Work& w : work) {
    amounts.at(homes.of(w.at)) += w.amount;
    total += w.amount;
  }
  for (const double amount : amounts) EXPECT_NEAR(amount * num_homes_ / total, 1, 0.1);
}

// A point in the bounding box of points of one block lies in that block.
TEST_P(HomesOfSeed, AreBlocks) {
  const Homes homes(some_work(200 * num_homes_), num_homes_);
  std::vector<std::pair<Point, Point>> corners(num_homes_, {{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}});
  const auto random_point = [&] { return Point{coordinate(), 0.3 * coordinate(), 2 * coordinate()}; };
  for (int i = 0; i < 4000; ++i) {
    const Point p = random_point();
    auto& [low, high] = corners[homes.of(p)];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  for (int i = 0; i < 4000; ++i) {
    const Point p = random_point();
    for (unsigned home = 0; home < num_homes_; ++home) {
      const auto& [low, high] = corners[home];
      const bool is_within =
          p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
      if (is_within) {
        EXPECT_EQ(homes.of(p), home);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, HomesOfSeed, testing::Range(0u, 30u));

TEST(Homes, TileSpaceWhateverWorkThereIs) {
  const Point here{1, 2, 3};
  for (const std::vector<Homes::Work>& work : {std::vector<Homes::Work>{},
                                               {{here, 1}},
                                               {{here, 1}, {here, 1}, {here, 1}},
                                               {{here, 0}, {{4, 5, 6}, 0}}})
    for (const unsigned num_homes : {1u, 2u, 5u, 16u}) {
      const Homes homes(work, num_homes);
      for (const Point& p : {here, Point{-1e300, 0, 1e300}, Point{}}) EXPECT_LT(homes.of(p), num_homes);
    }
}

}  // namespace
}  // namespace podm::test
