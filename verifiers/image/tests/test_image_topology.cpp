// Components and Euler numbers of shapes whose topology is known.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "image/image_topology.h"

namespace podm::verify {
namespace {

Image image_of(int n, const std::function<std::uint32_t(int, int, int)>& label) {
  Image image;
  image.size = {n, n, n};
  image.spacing = {1, 1, 1};
  image.voxel_to_ras = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) image.voxels.push_back(label(i, j, k));
  return image;
}

void expect(const Topology& t, std::uint64_t components_6, std::uint64_t components_26, std::int64_t euler_6,
            std::int64_t euler_26) {
  EXPECT_EQ(t.components_6, components_6);
  EXPECT_EQ(t.components_26, components_26);
  EXPECT_EQ(t.euler_6, euler_6);
  EXPECT_EQ(t.euler_26, euler_26);
}

TEST(ImageTopology, BallRingAndShell) {
  const auto inside = [](int i, int j, int k, int radius) {
    return (i - 8) * (i - 8) + (j - 8) * (j - 8) + (k - 8) * (k - 8) <= radius * radius;
  };
  expect(find_topology(image_of(17, [&](int i, int j, int k) { return inside(i, j, k, 6) ? 3U : 0U; }), 2)
             .of_label.at(3),
         1, 1, 1, 1);
  expect(
      find_topology(image_of(17, [&](int i, int j,
                                     int k) { return inside(i, j, k, 7) && !inside(i, j, k, 4) ? 3U : 0U; }),
                    2)
          .of_label.at(3),
      1, 1, 2, 2);
  expect(find_topology(image_of(5,
                                [](int i, int j, int k) {
                                  const bool is_rim = std::max(std::abs(i - 2), std::abs(j - 2)) == 1;
                                  return is_rim && k == 2 ? 3U : 0U;
                                }),
                       2)
             .of_label.at(3),
         1, 1, 0, 0);
}

TEST(ImageTopology, AtTheBorderAsInside) {
  expect(find_topology(image_of(3, [](int, int, int) { return 1U; }), 1).of_label.at(1), 1, 1, 1, 1);
}

TEST(ImageTopology, VoxelsThatMeetAtACornerOrAnEdge) {
  for (const int k : {0, 1}) {
    const Image image = image_of(
        2, [k](int i, int j, int z) { return (i == 0 && j == 0 && z == 0) || (i == 1 && j == 1 && z == k); });
    expect(find_topology(image, 1).of_label.at(1), 2, 1, 2, 1);
  }
}

TEST(ImageTopology, LabelsApartAndTogether) {
  const Image image = image_of(6, [](int i, int j, int k) {
    if (std::min({i, j, k}) == 0 || std::max({i, j, k}) == 5) return 0U;
    return i < 3 ? 4U : 70000U;
  });
  const ImageTopology topology = find_topology(image, 3);
  expect(topology.of_label.at(4), 1, 1, 1, 1);
  expect(topology.of_label.at(70000), 1, 1, 1, 1);
  expect(topology.all, 1, 1, 1, 1);
  EXPECT_EQ(topology.all.voxels, 64U);
  EXPECT_EQ(topology.of_label.size(), 2U);
}

// The 6-connected object and the 26-connected rest of the box share one surface. The box has another one, a
// sphere. The Euler number of a solid is half that of its surface. Therefore chi(rest) = chi(object) + 1.
TEST(ImageTopology, ObjectAndComplementHaveOneBoundary) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const int n = 8;
    const Image image = image_of(n, [&](int i, int j, int k) {
      const bool is_padding = std::min({i, j, k}) == 0 || std::max({i, j, k}) == n - 1;
      return !is_padding && random() % 2 == 0 ? 1U : 0U;
    });
    Image complement = image;
    for (auto& voxel : complement.voxels) voxel = 1 - voxel;
    const Topology object = find_topology(image, 2).of_label.at(1),
                   rest = find_topology(complement, 2).of_label.at(1);
    EXPECT_EQ(object.euler_6, rest.euler_26 - 1);
    EXPECT_EQ(object.euler_26, rest.euler_6 - 1);
  }
}

}  // namespace
}  // namespace podm::verify
