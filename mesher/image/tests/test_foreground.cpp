// The numbers of voxels by label, counted voxel by voxel for comparison.
#include "image/foreground.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace podm::test {
namespace {

LabelImage image_of(std::array<int, 3> size, std::size_t num_labels) {
  LabelImage image;
  image.size = size;
  image.spacing = {1, 1, 1};
  image.labels.resize(num_labels);
  image.voxels.assign(image.num_voxels(), kBackground);
  return image;
}

void expect_counts(const LabelImage& image) {
  std::vector<std::uint64_t> expected(image.labels.size());
  for (const LabelIndex label : image.voxels) ++expected[label];
  for (const int threads : {1, 3}) EXPECT_EQ(count_voxels(image, threads), expected) << threads;
}

// Rows end within a stretch of equal voxels, at its end, and far beyond it.
constexpr std::array<std::array<int, 3>, 8> kSizes{
    {{1, 1, 1}, {63, 3, 2}, {64, 2, 3}, {65, 1, 4}, {1, 200, 3}, {128, 2, 2}, {700, 3, 1}, {40'000, 2, 2}}};

TEST(CountVoxels, CountsEachVoxelOfUniformImages) {
  for (const auto& size : kSizes)
    for (const LabelIndex label : {0, 1, static_cast<int>(kMaxLabels) - 1}) {
      LabelImage image = image_of(size, kMaxLabels);
      std::fill(image.voxels.begin(), image.voxels.end(), label);
      expect_counts(image);
    }
}

TEST(CountVoxels, CountsEachVoxelOfRandomLabels) {
  std::mt19937 random(1);
  for (const auto& size : kSizes) {
    for (const std::size_t num_labels : {std::size_t{2}, std::size_t{700}, kMaxLabels}) {
      LabelImage image = image_of(size, num_labels);
      for (LabelIndex& label : image.voxels) label = static_cast<LabelIndex>(random() % num_labels);
      image.voxels.back() = static_cast<LabelIndex>(num_labels - 1);
      expect_counts(image);
    }
  }
}

TEST(CountVoxels, CountsEachVoxelOfRandomStretches) {
  std::mt19937 random(2);
  for (const auto& size : kSizes) {
    for (const unsigned longest : {3u, 70u, 300u, 20'000u}) {
      LabelImage image = image_of(size, kMaxLabels);
      for (auto from = image.voxels.begin(); from != image.voxels.end();) {
        const auto length = std::min<std::ptrdiff_t>(1 + random() % longest, image.voxels.end() - from);
        std::fill_n(from, length, static_cast<LabelIndex>(random() % kMaxLabels));
        from += length;
      }
      expect_counts(image);
    }
  }
}

// One voxel that differs is not taken for one of its stretch, wherever it lies.
TEST(CountVoxels, CountsASingleVoxelAtEveryPlace) {
  for (const int size : {1, 63, 64, 65, 130})
    for (int i = 0; i < size; ++i) {
      LabelImage image = image_of({size, 1, 1}, 3);
      std::fill(image.voxels.begin(), image.voxels.end(), LabelIndex{2});
      image.voxels[static_cast<std::size_t>(i)] = 1;
      expect_counts(image);
    }
}

}  // namespace
}  // namespace podm::test
