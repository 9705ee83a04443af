#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "image/feature_transform.h"
#include "isosurface_reference.h"
#include "podm/errors.h"

namespace podm::test {
namespace {

struct Position {
  int i, j, k;
};

Position position(const LabelImage& image, std::size_t index) {
  const auto n = static_cast<std::size_t>(image.size[0]), m = static_cast<std::size_t>(image.size[1]);
  return {static_cast<int>(index % n), static_cast<int>(index / n % m), static_cast<int>(index / n / m)};
}

double squared_mm(const LabelImage& image, std::size_t a, std::size_t b) {
  const Position p = position(image, a), q = position(image, b);
  const double x = (p.i - q.i) * image.spacing[0], y = (p.j - q.j) * image.spacing[1],
               z = (p.k - q.k) * image.spacing[2];
  return x * x + y * y + z * z;
}

std::vector<std::size_t> surface_voxels(const LabelImage& image) {
  const auto label = [&](int i, int j, int k) {
    const bool is_in =
        i >= 0 && j >= 0 && k >= 0 && i < image.size[0] && j < image.size[1] && k < image.size[2];
    return is_in ? image.voxels[image.index(i, j, k)] : kBackground;
  };
  std::vector<std::size_t> found;
  for (std::size_t v = 0; v < image.num_voxels(); ++v) {
    const auto [i, j, k] = position(image, v);
    for (const auto [a, b, c] :
         {Position{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}) {
      if (label(i + a, j + b, k + c) == image.voxels[v]) continue;
      found.push_back(v);
      break;
    }
  }
  return found;
}

void expect_equals_brute_force(const LabelImage& image) {
  const FeatureTransform transform(image, 1);
  const std::vector<std::size_t> surface = surface_voxels(image);
  for (std::size_t v = 0; v < image.num_voxels(); ++v) {
    const std::size_t feature = transform.nearest(v);
    if (surface.empty()) {
      ASSERT_EQ(feature, FeatureTransform::kNone);
      continue;
    }
    ASSERT_TRUE(std::binary_search(surface.begin(), surface.end(), feature));
    double nearest2 = std::numeric_limits<double>::infinity();
    for (const std::size_t s : surface) nearest2 = std::min(nearest2, squared_mm(image, v, s));
    ASSERT_NEAR(squared_mm(image, v, feature), nearest2, 1e-12 * nearest2);
  }
}

class FeatureTransformSizes : public testing::TestWithParam<std::array<int, 3>> {};

TEST_P(FeatureTransformSizes, EqualsBruteForce) {
  Random random(1);
  for (const auto& spacing : {std::array{1.0, 1.0, 1.0}, {0.617, 0.617, 1.333}, {2.5, 0.1, 0.9}}) {
    for (const double coherence : {0.0, 0.8, 0.97}) {
      expect_equals_brute_force(random_image(random, GetParam(), spacing, 2, coherence));
      expect_equals_brute_force(random_image(random, GetParam(), spacing, 5, coherence));
    }
  }
}

TEST_P(FeatureTransformSizes, OneVoxelAndNoneAndAll) {
  for (const LabelIndex outer : {0, 1}) {
    LabelImage image = empty_image(GetParam(), {0.7, 1.1, 1.9});
    std::fill(image.voxels.begin(), image.voxels.end(), outer);
    expect_equals_brute_force(image);
    image.voxels[image.num_voxels() / 3] = 2;
    expect_equals_brute_force(image);
  }
}

INSTANTIATE_TEST_SUITE_P(, FeatureTransformSizes,
                         testing::Values(std::array{9, 8, 11}, std::array{1, 7, 6}, std::array{40, 1, 5},
                                         std::array{6, 70, 1}, std::array{1, 1, 9}, std::array{1, 1, 1},
                                         std::array{33, 5, 4}));

TEST(FeatureTransform, DoesNotDependOnThreads) {
  Random random(2);
  const LabelImage image = random_image(random, {37, 29, 23}, {1, 1, 1}, 3, 0.97);
  const FeatureTransform one(image, 1);
  for (const int threads : {0, 2, 3, 100}) {
    const FeatureTransform many(image, threads);
    for (std::size_t v = 0; v < image.num_voxels(); ++v) ASSERT_EQ(one.nearest(v), many.nearest(v));
  }
}

TEST(FeatureTransform, RefusesMoreVoxelsThanItCanNumber) {
  LabelImage image;
  image.size = {65536, 65536, 1};
  image.spacing = {1, 1, 1};
  EXPECT_THROW(FeatureTransform(image, 1), InputError);
}

}  // namespace
}  // namespace podm::test
