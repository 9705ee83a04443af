// An island takes the label that it touches most.
#include "image/islands.h"

#include <gtest/gtest.h>

#include "errors.h"

namespace podm::verify {
namespace {

Image row(std::vector<std::uint32_t> voxels) {
  Image image;
  image.path = "a.nii";
  image.size = {static_cast<int>(voxels.size()), 1, 1};
  image.spacing = {1, 0.1, 0.1};  // faces across x are a tenth of the others
  image.voxel_to_ras = {1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1, 0};
  image.voxels = std::move(voxels);
  return image;
}

std::vector<std::uint32_t> dropped(std::vector<std::uint32_t> voxels, double below_mm3) {
  Image image = row(std::move(voxels));
  drop_islands(image, 0, below_mm3);
  return image.voxels;
}

using Values = std::vector<std::uint32_t>;

TEST(Islands, OfARowBorderOnTheOutsideMost) {
  EXPECT_EQ(dropped({1, 1, 1, 2, 1, 1, 1}, 0.015), (Values{1, 1, 1, 0, 1, 1, 1}));
  EXPECT_EQ(dropped({1, 1, 1, 2, 1, 1, 1}, 0.01), (Values{1, 1, 1, 2, 1, 1, 1}));
}

TEST(Islands, WithinIslandsWait) {
  Image image;
  image.size = {7, 7, 7};
  image.spacing = {1, 1, 1};
  image.voxel_to_ras = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 7; ++j)
      for (int i = 0; i < 7; ++i) {
        const int from_middle = std::abs(i - 3) + std::abs(j - 3) + std::abs(k - 3);
        image.voxels.push_back(from_middle == 0 ? 3 : from_middle == 1 ? 2 : 1);
      }
  drop_islands(image, 0, 8);
  EXPECT_EQ(image.voxels, std::vector<std::uint32_t>(343, 1));
}

TEST(Islands, ThatAreAllAreRefused) { EXPECT_THROW(dropped({1, 1, 2, 2}, 1), InputError); }

}  // namespace
}  // namespace podm::verify
