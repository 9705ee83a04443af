// A voxel is simple exactly if no region of the set or of the rest changes when it enters or leaves.
#include "topology/simple_voxel.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/images.h"
#include "topology/image_regions.h"

namespace podm {
namespace {

std::array<std::int64_t, 3> numbers_of(Around27 set) {
  const LabelImage image = test::make_image({3, 3, 3}, {1, 1, 1}, 1, [&](int i, int j, int k) {
    return static_cast<int>(set >> (9 * k + 3 * j + i) & 1);
  });
  const ImageRegions regions(image, [](const Point&) { return kBackground; });
  std::array<std::int64_t, 3> sums{static_cast<std::int64_t>(regions.size()), 0, 0};
  for (std::uint32_t r = 0; r < regions.size(); ++r) {
    sums[1] += regions[r].handles;
    sums[2] += regions[r].cavities;
  }
  return sums;
}

TEST(SimpleVoxel, KeepsAllNumbersOfItsSurroundings) {
  std::mt19937 random(3);
  int simple = 0;
  for (int n = 0; n < 3000; ++n) {
    Around27 set = 0;
    const unsigned share = 1 + static_cast<unsigned>(n) % 9;
    for (unsigned v = 0; v < 27; ++v) set |= static_cast<Around27>(random() % 10 < share) << v;
    if (!is_simple(set)) continue;
    ++simple;
    EXPECT_EQ(numbers_of(set | simple_voxel::kMiddle), numbers_of(set & ~simple_voxel::kMiddle)) << set;
  }
  EXPECT_GT(simple, 200);
}

TEST(SimpleVoxel, KnownCases) {
  using namespace simple_voxel;
  EXPECT_FALSE(is_simple(0));     // it would be new
  EXPECT_FALSE(is_simple(kAll));  // a cavity
  EXPECT_TRUE(is_simple(1u << 14));
  EXPECT_FALSE(is_simple(1u << 14 | 1u << 12));           // a bridge
  EXPECT_FALSE(is_simple(kAll & ~(1u << 4 | 1u << 22)));  // a hole in a plate
  EXPECT_FALSE(is_simple(1u << 0));                       // no face joins it
}

}  // namespace
}  // namespace podm
