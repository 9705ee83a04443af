// After islands are dropped, no island is left, and other components are unchanged.
#include "image/islands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "image/components.h"
#include "podm/errors.h"
#include "tests/fault_of.h"
#include "tests/images.h"

namespace podm {
namespace {

LabelImage dropped(LabelImage image, double below_mm3) {
  drop_islands(image, below_mm3, "a.nii");
  return image;
}

// Random blobs of voxels, with islands beside and within islands.
LabelImage blobs(unsigned seed) {
  std::mt19937 random(seed);
  LabelImage image = test::make_image({14, 12, 10}, {1, 0.5, 2}, 4, [&](int i, int j, int k) {
    return i > 1 && i < 9 && j > 1 && j < 9 && k > 1 && k < 8 ? 1 : 0;
  });
  for (int n = 0; n < 60; ++n)
    image.voxels[random() % image.voxels.size()] = static_cast<LabelIndex>(random() % 5);
  return image;
}

TEST(Islands, NoneIsLeft) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const LabelImage before = blobs(seed);
    for (const double below_mm3 : {1.5, 3.0, 8.0, 40.0}) {
      const LabelImage after = dropped(before, below_mm3);
      const Components components(after);
      for (Components::Id c = 0; c < components.size(); ++c)
        EXPECT_TRUE(components[c].label == kBackground ||
                    static_cast<double>(components[c].num_voxels) >= below_mm3 * (1 - 1e-5));
    }
  }
}

TEST(Islands, DroppingAgainChangesNothing) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const LabelImage once = dropped(blobs(seed), 5);
    LabelImage twice = once;
    twice.dropped_islands.clear();
    drop_islands(twice, 5, "a.nii");
    EXPECT_EQ(once.voxels, twice.voxels);
    EXPECT_TRUE(twice.dropped_islands.empty());
  }
}

TEST(Islands, LargeIslandsStayAndDroppedOnesAreReported) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const LabelImage before = blobs(seed), after = dropped(before, 5);
    const Components components(before);
    std::vector<std::uint64_t> gone(before.labels.size());
    std::size_t at = 0;
    for (int k = 0; k < before.size[2]; ++k)
      for (int j = 0; j < before.size[1]; ++j)
        for (int i = 0; i < before.size[0]; ++i, ++at) {
          const Component& own = components[components.of({i, j, k})];
          const bool is_island = own.label != kBackground && own.num_voxels < 5;
          const bool is_kept = after.labels[after.voxels[at]].value == before.labels[own.label].value;
          ASSERT_TRUE(is_island || is_kept);
          if (is_island) ++gone[own.label];
        }
    for (const DroppedIslands& islands : after.dropped_islands)
      EXPECT_GE(islands.volume_mm3, static_cast<double>(gone[islands.label.value / 10]));
  }
}

TEST(Islands, GoToTheLabelThatTheyTouchMost) {
  // Two voxels of label 3 side by side, with label 1 below and label 2 above. The faces across z are the
  // largest.
  const LabelImage image = dropped(test::make_image({6, 6, 6}, {1, 1, 0.25}, 3,
                                                    [](int i, int j, int k) {
                                                      if (k == 3 && j == 2 && (i == 2 || i == 3)) return 3;
                                                      return k <= 2 ? 1 : k == 3 && i > 2 ? 1 : 2;
                                                    }),
                                   1);
  EXPECT_EQ(image.voxels[image.index(2, 2, 3)], 1);
  EXPECT_EQ(image.voxels[image.index(3, 2, 3)], 1);
  ASSERT_EQ(image.labels.size(), 3u);
  ASSERT_EQ(image.warnings.size(), 1u);  // label 30 is gone
  EXPECT_NE(image.warnings[0].find("label 30"), std::string::npos);
  EXPECT_NE(image.warnings[0].find("0.5 mm^3"), std::string::npos);
}

TEST(Islands, AtTheBorderTouchTheBackground) {
  const LabelImage image = dropped(
      test::make_image({5, 5, 5}, {1, 1, 1}, 2, [](int i, int j, int k) { return i + j + k == 0 ? 2 : 1; }),
      2);
  EXPECT_EQ(image.voxels[0], kBackground);  // three faces each: a tie goes to the background
}

TEST(Islands, OfNonsenseAreRefused) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_NE(fault_of<InputError>([&] { dropped(test::ball(8, 3), bad); }).find("positive volume"),
              std::string::npos);
  EXPECT_NE(fault_of<InputError>([] { dropped(test::ball(8, 3), 1e6); }).find("no label"), std::string::npos);
}

}  // namespace
}  // namespace podm
