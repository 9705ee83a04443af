// Leaves are as large as possible while nodes find enough of them, for any shape of the box.
#include "algorithms/leaf_size.h"

#include <gtest/gtest.h>

#include <cmath>

#include "image/foreground.h"
#include "tests/images.h"

namespace podm::test {
namespace {

constexpr double kLeavesPerNode = 64;
constexpr double kLongerSide = 1.27;  // slightly more than a step between the sides that are tried

// Objects that fill their box, with bounds that allow leaves far smaller than needed.
class LeafSizeIn : public testing::TestWithParam<std::array<int, 3>> {};

TEST_P(LeafSizeIn, NextLongerSideMakesTooFewLeaves) {
  const LabelImage image = make_image(GetParam(), {1, 1, 1}, 1, [](int, int, int) { return 1; });
  const Isosurface isosurface(image, 1);
  const Box box = foreground_bounds(image);
  const Problem problem{
      .isosurface = isosurface, .object = box, .delta_mm = 0.02, .sizes = SizeField({0.02, 0.02})};
  for (const int num_nodes : {1, 4, 7}) {
    const auto nodes = static_cast<std::uint64_t>(num_nodes);
    const auto octree = make_octree(problem, radii_of(problem), box, {.initial_ratio = 4}, nodes, {});
    const Vector extent = box.high - box.low;
    const double longer_mm = kLongerSide * octree->finest_side_mm();
    const double num_longer =
        std::ceil(extent.x / longer_mm) * std::ceil(extent.y / longer_mm) * std::ceil(extent.z / longer_mm);
    EXPECT_GE(octree->num_leaves(), kLeavesPerNode * num_nodes) << num_nodes << " nodes";
    EXPECT_LT(num_longer, kLeavesPerNode * num_nodes) << num_nodes << " nodes";
  }
}

INSTANTIATE_TEST_SUITE_P(Boxes, LeafSizeIn,
                         testing::Values(std::array{40, 40, 40}, std::array{64, 64, 2}, std::array{64, 2, 64},
                                         std::array{400, 1, 1}));

}  // namespace
}  // namespace podm::test
