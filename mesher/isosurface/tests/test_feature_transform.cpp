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

// The edges of the voxel to neighbors of another label, as in Neighborhood::changing_edges(). Outside the
// grid everything is background.
unsigned changing_edges(const LabelImage& image, std::size_t v) {
  const auto label = [&](int i, int j, int k) {
    const bool is_in =
        i >= 0 && j >= 0 && k >= 0 && i < image.size[0] && j < image.size[1] && k < image.size[2];
    return is_in ? image.voxels[image.index(i, j, k)] : kBackground;
  };
  const auto [i, j, k] = position(image, v);
  unsigned edges = 0, edge = 1;
  for (const auto [a, b, c] : {Voxel{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}) {
    if (label(i + a, j + b, k + c) != image.voxels[v]) edges |= edge;
    edge <<= 1;
  }
  return edges;
}

std::vector<std::size_t> surface_voxels(const LabelImage& image) {
  std::vector<std::size_t> found;
  for (std::size_t v = 0; v < image.num_voxels(); ++v)
    if (changing_edges(image, v) != 0) found.push_back(v);
  return found;
}

double least_squared_mm(const LabelImage& image, std::size_t v, const std::vector<std::size_t>& surface) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t s : surface) least = std::min(least, squared_mm(image, v, s));
  return least;
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
    const double nearest2 = least_squared_mm(image, v, surface);
    ASSERT_NEAR(squared_mm(image, v, feature), nearest2, 1e-12 * nearest2);
  }
}

// Compares what is stored of each voxel, and of the corners of each box of one or two voxels per axis.
// Returns the number of boxes of which all features are stored, and the number of other boxes.
std::array<int, 2> expect_stored_equals_brute_force(const LabelImage& image) {
  const FeatureTransform transform(image, 1);
  const Features<NoReads> features(transform, {});
  const std::vector<std::size_t> surface = surface_voxels(image);
  std::vector<double> least;
  for (std::size_t v = 0; v < image.num_voxels(); ++v) {
    least.push_back(least_squared_mm(image, v, surface));
    const StoredFeature stored = features.stored(features.brick_of(position(image, v)), position(image, v));
    EXPECT_EQ(stored.is_surface(), least[v] == 0);
    if (stored.is_surface()) {
      EXPECT_EQ(stored.label(), std::min(image.voxels[v], StoredFeature::kLabelTooLarge));
    }
  }
  std::array<int, 2> num_boxes{};
  const double squared_reach = transform.reach_mm() * transform.reach_mm();
  const auto expect_at = [&](const Voxel& low, const Voxel& high) {
    const std::optional<EightVoxels> nearest = features.nearest_to_corners(low, high);
    ++num_boxes[nearest ? 0 : 1];
    bool are_all_near = true;
    for (unsigned c = 0; c < EightVoxels::kNum; ++c) {
      const std::size_t corner = image.index((c & 1) != 0 ? high.i : low.i, (c & 2) != 0 ? high.j : low.j,
                                             (c & 4) != 0 ? high.k : low.k);
      are_all_near = are_all_near && least[corner] < squared_reach * (1 - 1e-12);
      if (!nearest) continue;
      const Voxel found = (*nearest)[c];
      const std::size_t feature = image.index(found.i, found.j, found.k);
      ASSERT_TRUE(std::binary_search(surface.begin(), surface.end(), feature));
      ASSERT_NEAR(squared_mm(image, corner, feature), least[corner], 1e-12 * least[corner]);
    }
    if (are_all_near) {
      ASSERT_TRUE(nearest);
    }
  };
  for (std::size_t v = 0; v < image.num_voxels(); ++v) {
    const Voxel low = position(image, v);
    for (const int i : {0, 1})
      for (const int j : {0, 1})
        for (const int k : {0, 1}) {
          const Voxel high{low.i + i, low.j + j, low.k + k};
          if (high.i < image.size[0] && high.j < image.size[1] && high.k < image.size[2])
            expect_at(low, high);
        }
  }
  return num_boxes;
}

void expect_changing_edges_equal_brute_force(const LabelImage& image, Random& random) {
  const FeatureTransform transform(image, 1);
  const Features<NoReads> features(transform, {});
  const std::vector<std::size_t> surface = surface_voxels(image);
  for (std::size_t first = 0; first < surface.size(); ++first) {
    std::array<std::size_t, EightVoxels::kNum> chosen;
    for (std::size_t& v : chosen) v = surface[random() % surface.size()];
    chosen[first % chosen.size()] = surface[first];
    EightVoxels voxels{};
    for (int c = 0; c < static_cast<int>(chosen.size()); ++c) {
      const Voxel at = position(image, chosen[static_cast<std::size_t>(c)]);
      voxels.i[c] = at.i, voxels.j[c] = at.j, voxels.k[c] = at.k;
    }
    const EightVoxels::Ints edges = features.changing_edges(voxels);
    for (int c = 0; c < static_cast<int>(chosen.size()); ++c) {
      const std::size_t v = chosen[static_cast<std::size_t>(c)];
      ASSERT_EQ(static_cast<unsigned>(edges[c]), changing_edges(image, v)) << v;
      const std::optional<Neighborhood> around = features.neighborhood_if_surface(position(image, v));
      ASSERT_TRUE(around);
      ASSERT_EQ(around->changing_edges(), changing_edges(image, v)) << v;
    }
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

// Labels that fit in a word, that just do or do not, and that mostly do not.
TEST_P(FeatureTransformSizes, WordsEqualBruteForce) {
  Random random(5);
  for (const auto& spacing : {std::array{1.0, 1.0, 1.0}, {2.5, 0.1, 0.9}}) {
    for (const double coherence : {0.0, 0.8, 0.97}) {
      for (const unsigned num_labels : {2u, 5u, 6'000u}) {
        LabelImage image = random_image(random, GetParam(), spacing, num_labels, coherence);
        if (num_labels == 5)
          for (LabelIndex& label : image.voxels)
            if (label != kBackground) label += StoredFeature::kLabelTooLarge - 3;
        expect_stored_equals_brute_force(image);
        expect_changing_edges_equal_brute_force(image, random);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, FeatureTransformSizes,
                         testing::Values(std::array{9, 8, 11}, std::array{1, 7, 6}, std::array{40, 1, 5},
                                         std::array{6, 70, 1}, std::array{1, 1, 9}, std::array{1, 1, 1},
                                         std::array{33, 5, 4}, std::array{5, 6, 7}));

TEST(FeatureTransform, EqualsBruteForceFarFromTheSurface) {
  Random random(4);
  LabelImage image = empty_image({61, 47, 50}, {0.617, 0.617, 1.333});
  for (int n = 0; n < 6; ++n) image.voxels[random() % image.num_voxels()] = 1;
  expect_equals_brute_force(image);
}

// Boxes lie within and beyond the reach of the features, in near and far bricks, and across their sides.
TEST(FeatureTransform, StoresAllCornersOfABoxOrNone) {
  Random random(6);
  for (const auto& spacing : {std::array{1.0, 1.0, 1.0}, {0.617, 0.617, 1.333}}) {
    LabelImage image = empty_image({45, 38, 31}, spacing);
    for (int n = 0; n < 4; ++n) image.voxels[random() % image.num_voxels()] = 1;
    const auto [num_stored, num_others] = expect_stored_equals_brute_force(image);
    EXPECT_GT(num_stored, 1000);
    EXPECT_GT(num_others, 1000);
  }
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
  image.voxels.resize(1);  // an image without any stays in its file
  EXPECT_THROW(FeatureTransform(image, 1), InputError);
}

}  // namespace
}  // namespace podm::test
