// Tests plates, rods and balls of known thickness, and the kinds of their thin parts.
#include "image/thin_parts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/images.h"

namespace podm {
namespace {

LabelImage plate(int thickness, std::array<double, 3> spacing = {1, 1, 1}) {
  return test::make_image({24, 24, 16}, spacing, 1, [=](int i, int j, int k) {
    return i > 2 && i < 21 && j > 2 && j < 21 && k >= 4 && k < 4 + thickness;
  });
}

std::uint64_t num_thin(const LabelImage& image, double delta_mm, ThinKind kind) {
  std::uint64_t count = 0;
  for (const ThinPart& part : find_thin_parts(image, delta_mm, 2))
    count += part.kind == kind ? part.num_voxels : 0;
  return count;
}

TEST(ThinParts, APlateIsThinForADistanceAboveItsThickness) {
  for (int thickness = 1; thickness <= 7; thickness += 2) {
    const LabelImage image = plate(thickness);
    const std::uint64_t all = static_cast<std::uint64_t>(18 * 18 * thickness);
    EXPECT_EQ(num_thin(image, thickness, ThinKind::kWhole), all);
    const auto parts = find_thin_parts(image, thickness, 1);
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_DOUBLE_EQ(parts[0].thickness_mm, thickness);
    EXPECT_EQ(parts[0].label, 1);
    EXPECT_EQ(parts[0].deepest.k, 4 + thickness / 2);
    EXPECT_TRUE(thickness == 1 || num_thin(image, 0.7 * thickness, ThinKind::kWhole) == 0);
  }
}

TEST(ThinParts, SpacingCounts) {
  const LabelImage image = plate(3, {1, 1, 2});
  EXPECT_GT(num_thin(image, 6, ThinKind::kWhole), 0u);
  EXPECT_EQ(num_thin(image, 4, ThinKind::kWhole), 0u);
}

TEST(ThinParts, ARodBetweenBallsIsABridgeAndAtOneADetail) {
  const auto rod = [](bool has_both) {
    return test::make_image({40, 15, 15}, {1, 1, 1}, 1, [=](int i, int j, int k) {
      const auto near = [&](int center) { return std::hypot(i - center, j - 7, k - 7) < 5.5; };
      return near(7) || (has_both && near(32)) || (j == 7 && k == 7 && i > 7 && i < 32);
    });
  };
  EXPECT_GE(num_thin(rod(true), 2, ThinKind::kBridge), 12u);
  EXPECT_EQ(num_thin(rod(true), 2, ThinKind::kWhole), 0u);
  EXPECT_EQ(num_thin(rod(false), 2, ThinKind::kBridge), 0u);
  EXPECT_GE(num_thin(rod(false), 2, ThinKind::kDetail), 12u);
}

TEST(ThinParts, AThickBallHasNone) {
  for (const double delta_mm : {0.5, 1.0, 2.0, 3.0}) {
    EXPECT_EQ(num_thin(test::ball(40, 15), delta_mm, ThinKind::kWhole), 0u);
    EXPECT_LT(num_thin(test::ball(40, 15), delta_mm, ThinKind::kDetail), 300u);  // of about 14000
  }
}

TEST(ThinParts, TheLargestOfAKindComesFirstAndThreadsChangeNothing) {
  for (const test::NamedImage& named : test::images()) {
    const LabelImage image = named.make();
    const auto one = find_thin_parts(image, 2, 1), three = find_thin_parts(image, 2, 3);
    ASSERT_EQ(one.size(), three.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].deepest, three[i].deepest);
      EXPECT_EQ(image.voxels[image.index(one[i].deepest.i, one[i].deepest.j, one[i].deepest.k)],
                one[i].label);
      EXPECT_TRUE(i == 0 || one[i - 1].kind < one[i].kind || one[i - 1].num_voxels >= one[i].num_voxels);
    }
  }
}

}  // namespace
}  // namespace podm
