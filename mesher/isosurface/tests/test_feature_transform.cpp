#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "isosurface/feature_transform.h"
#include "isosurface_reference.h"
#include "podm/errors.h"

namespace podm::test {
namespace {

Voxel position(const LabelImage& image, std::size_t index) {
  const auto n = static_cast<std::size_t>(image.size[0]), m = static_cast<std::size_t>(image.size[1]);
  return {static_cast<int>(index % n), static_cast<int>(index / n % m), static_cast<int>(index / n / m)};
}

double squared_mm(const LabelImage& image, std::size_t a, std::size_t b) {
  const Voxel p = position(image, a), q = position(image, b);
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
    for (const auto [a, b, c] : {Voxel{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}) {
      if (label(i + a, j + b, k + c) == image.voxels[v]) continue;
      found.push_back(v);
      break;
    }
  }
  return found;
}

void expect_equals_brute_force(const LabelImage& image) {
  const FeatureTransform transform(image, 1);
  const Features<NoReads> features(transform, {});
  const std::vector<std::size_t> surface = surface_voxels(image);
  ASSERT_EQ(features.is_empty(), surface.empty());
  if (surface.empty()) return;
  for (std::size_t v = 0; v < image.num_voxels(); ++v) {
    const Voxel at = position(image, v), nearest = *features.nearest(center(at), 1e9);
    const std::size_t feature = image.index(nearest.i, nearest.j, nearest.k);
    const auto offset = features.stored(features.brick_of(at), at).offset();
    if (offset) {
      const std::size_t found = image.index(at.i + offset->i, at.j + offset->j, at.k + offset->k);
      ASSERT_TRUE(std::binary_search(surface.begin(), surface.end(), found));
      ASSERT_NEAR(squared_mm(image, v, found), squared_mm(image, v, feature), 1e-12);
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

TEST(FeatureTransform, EqualsBruteForceFarFromTheSurface) {
  Random random(4);
  LabelImage image = empty_image({61, 47, 50}, {0.617, 0.617, 1.333});
  for (int n = 0; n < 6; ++n) image.voxels[random() % image.num_voxels()] = 1;
  expect_equals_brute_force(image);
}

// The gap between the box of `length` voxels from `first` on and the box of one more voxel, mm.
double gap(int first, int length, int voxel, double spacing) {
  return spacing * std::max({0, first - voxel - 1, voxel - first - length});
}

// The bound of a far brick holds for the boxes of surface voxels. It equals the distance between the boxes of
// bricks except for less than a thousandth of the grid.
TEST(FeatureTransform, BoundsTheDistanceFromFarBricks) {
  Random random(3);
  for (const auto& spacing : {std::array{1.0, 1.0, 1.0}, {0.617, 0.617, 1.333}}) {
    LabelImage image = empty_image({61, 47, 50}, spacing);
    for (int n = 0; n < 6; ++n) image.voxels[random() % image.num_voxels()] = 1;
    const FeatureTransform transform(image, 1);
    const Features<NoReads> features(transform, {});
    const std::vector<std::size_t> surface = surface_voxels(image);
    int num_far = 0;
    for (int k = 0; k < image.size[2]; k += 4)
      for (int j = 0; j < image.size[1]; j += 4)
        for (int i = 0; i < image.size[0]; i += 4) {
          const Brick brick = features.brick_of({i, j, k});
          if (brick.is_near()) continue;
          ++num_far;
          double voxels = 1e9, bricks = 1e9;
          for (const std::size_t s : surface) {
            const Voxel v = position(image, s);
            voxels = std::min(voxels, std::hypot(gap(i, 4, v.i, spacing[0]), gap(j, 4, v.j, spacing[1]),
                                                 gap(k, 4, v.k, spacing[2])));
            const auto brick_gap = [&](int a, int b, std::size_t axis) {
              return 4 * gap(a / 4, 1, b / 4, spacing[axis]);
            };
            bricks = std::min(bricks,
                              std::hypot(brick_gap(i, v.i, 0), brick_gap(j, v.j, 1), brick_gap(k, v.k, 2)));
          }
          ASSERT_LE(features.distance_from_far(brick), voxels);
          ASSERT_NEAR(features.distance_from_far(brick), bricks, 0.1);
        }
    EXPECT_GT(num_far, 100);
  }
}

TEST(FeatureTransform, DoesNotDependOnThreads) {
  Random random(2);
  const LabelImage image = random_image(random, {37, 29, 23}, {1, 1, 1}, 3, 0.97);
  const FeatureTransform one(image, 1);
  for (const int threads : {0, 2, 3, 100}) {
    const FeatureTransform many(image, threads);
    ASSERT_TRUE(std::ranges::equal(one.words(), many.words()));
    ASSERT_GE(FeatureTransform::num_bytes(image, threads), one.words().size_bytes());
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
