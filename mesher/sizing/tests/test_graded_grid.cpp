// Graded values grow no faster than the slope. They are at most the envelope by straight distances, and below
// it by at most the documented factor. All are compared with a search of all pairs.
#include "sizing/graded_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace podm {
namespace {

constexpr std::array<int, 3> kSize{6, 5, 7};

std::size_t index(int i, int j, int k) { return static_cast<std::size_t>((k * kSize[1] + j) * kSize[0] + i); }

// Calls use(place, i, j, k) for each node.
template <class Use>
void for_each_node(const Use& use) {
  for (int k = 0; k < kSize[2]; ++k)
    for (int j = 0; j < kSize[1]; ++j)
      for (int i = 0; i < kSize[0]; ++i) use(index(i, j, k), i, j, k);
}

std::vector<float> some_values(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> any(0.5F, 9.0F);
  std::vector<float> values(index(0, 0, kSize[2]), std::numeric_limits<float>::infinity());
  for (int n = 0; n < 12; ++n) values[random() % values.size()] = any(random);
  return values;
}

// The least over all values, each increased by the slope times its straight distance.
double envelope(const std::vector<float>& values, const std::array<double, 3>& spacing, double slope, int i,
                int j, int k) {
  double least = std::numeric_limits<double>::infinity();
  for_each_node([&](std::size_t at, int x, int y, int z) {
    const double way = std::hypot((x - i) * spacing[0], (y - j) * spacing[1], (z - k) * spacing[2]);
    least = std::min(least, values[at] + slope * way);
  });
  return least;
}

TEST(GradedGrid, IsBetweenTheEnvelopesOfTheSlopeAndOfALittleLess) {
  for (const std::array<double, 3>& spacing : {std::array{1.0, 1.0, 1.0}, {0.6, 0.6, 1.4}, {2.0, 0.5, 1.0}}) {
    const double stretch = graded_stretch(spacing);
    for (const double slope : {0.05, 0.3, 2.0}) {
      for (unsigned seed = 0; seed < 10; ++seed) {
        const std::vector<float> values = some_values(seed);
        std::vector<float> graded = values;
        grade(kSize, spacing, slope, graded);
        for_each_node([&](std::size_t at, int i, int j, int k) {
          EXPECT_LE(graded[at], values[at]);
          EXPECT_LE(graded[at], envelope(values, spacing, slope, i, j, k) * (1 + 1e-6));
          EXPECT_GE(graded[at], envelope(values, spacing, slope / stretch, i, j, k) * (1 - 1e-6));
        });
      }
    }
  }
}

TEST(GradedGrid, GrowsNoFasterThanTheSlopeFromNodeToNode) {
  constexpr std::array<double, 3> kSpacing{0.7, 1, 2};
  constexpr double kSlope = 0.25;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::vector<float> values = some_values(seed);
    grade(kSize, kSpacing, kSlope, values);
    for_each_node([&](std::size_t at, int i, int j, int k) {
      for_each_node([&](std::size_t other, int x, int y, int z) {
        if (std::max({std::abs(x - i), std::abs(y - j), std::abs(z - k)}) > 1) return;
        const double way = std::hypot((x - i) * kSpacing[0], (y - j) * kSpacing[1], (z - k) * kSpacing[2]);
        EXPECT_LE(values[at], values[other] + kSlope * way * (1 + 1e-6));
      });
    });
    const std::vector<float> once = values;
    grade(kSize, kSpacing, kSlope, values);
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_NEAR(values[i], once[i], 1e-6 * once[i]) << "nothing is left to lower";
  }
}

TEST(GradedGrid, StretchesByAnEighthWhereSpacingsAreEqual) {
  EXPECT_NEAR(graded_stretch({3, 3, 3}), 1.1281, 1e-4);
  EXPECT_LT(graded_stretch({1, 1, 10}), std::sqrt(3.0));
}

TEST(GradedGrid, LeavesNothingToGradeAsItIs) {
  std::vector<float> values(index(0, 0, kSize[2]), std::numeric_limits<float>::infinity());
  grade(kSize, {1, 1, 1}, 0.5, values);
  for (const float value : values) EXPECT_EQ(value, std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace podm
