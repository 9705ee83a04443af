// Distances to interfaces equal those of a search of all faces.
#include "sizing/interface_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace podm {
namespace {

using Voxel3 = std::array<int, 3>;

LabelImage image_of(const Voxel3& size, const std::array<double, 3>& spacing,
                    std::vector<LabelIndex> voxels) {
  LabelImage image;
  image.size = size;
  image.spacing = spacing;
  image.voxel_to_ras = {spacing[0], 0, 0, 0, 0, spacing[1], 0, 0, 0, 0, spacing[2], 0};
  image.voxels = std::move(voxels);
  image.labels = {{0, ""}, {1, ""}, {2, ""}, {3, ""}};
  return image;
}

LabelImage random_image(const Voxel3& size, const std::array<double, 3>& spacing, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<LabelIndex> voxels(static_cast<std::size_t>(size[0] * size[1] * size[2]));
  for (LabelIndex& voxel : voxels)
    voxel = random() % 5 == 0 ? static_cast<LabelIndex>(1 + random() % 3) : kBackground;
  return image_of(size, spacing, std::move(voxels));
}

unsigned char side(const LabelImage& image, const std::vector<unsigned char>& sides, const Voxel3& v) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (v[axis] < 0 || v[axis] >= image.size[axis]) return sides[0];
  return sides[image.voxels[image.index(v[0], v[1], v[2])]];
}

struct Face {
  Voxel3 after;  // the voxel that follows the face
  std::size_t normal;
};

std::vector<Face> faces_of(const LabelImage& image, const std::vector<unsigned char>& sides) {
  std::vector<Face> faces;
  for (int k = 0; k <= image.size[2]; ++k)
    for (int j = 0; j <= image.size[1]; ++j)
      for (int i = 0; i <= image.size[0]; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          Voxel3 before{i, j, k};
          --before[axis];
          const int a = side(image, sides, {i, j, k}), b = side(image, sides, before);
          if (a + b == 3) faces.push_back({{i, j, k}, axis});
        }
  return faces;
}

double distance_to(const Face& face, const LabelImage& image, const Voxel3& v) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double steps = axis == face.normal ? std::abs(v[axis] - face.after[axis] + 0.5)
                                             : std::max(0.0, std::abs(v[axis] - face.after[axis]) - 0.5);
    squared += steps * steps * image.spacing[axis] * image.spacing[axis];
  }
  return std::sqrt(squared);
}

void expect_as_searched(const LabelImage& image, const std::vector<unsigned char>& sides, double reach_mm) {
  const auto faces = faces_of(image, sides);
  const auto found = interface_distances(image, sides, reach_mm, 2);
  ASSERT_EQ(found.has_value(), !faces.empty());
  if (!found) return;
  for (int k = -1; k <= image.size[2]; ++k)
    for (int j = -1; j <= image.size[1]; ++j)
      for (int i = -1; i <= image.size[0]; ++i) {
        double least = std::numeric_limits<double>::infinity();
        for (const Face& face : faces) least = std::min(least, distance_to(face, image, {i, j, k}));
        const Voxel3 at{i - found->first[0], j - found->first[1], k - found->first[2]};
        const bool is_in_part = std::all_of(at.begin(), at.end(), [](int x) { return x >= 0; }) &&
                                at[0] < found->size[0] && at[1] < found->size[1] && at[2] < found->size[2];
        if (least > reach_mm * (1 + 1e-6)) {
          if (is_in_part) continue;
        } else {
          ASSERT_TRUE(is_in_part) << i << ' ' << j << ' ' << k;
          const auto index =
              static_cast<std::size_t>((at[2] * found->size[1] + at[1]) * found->size[0] + at[0]);
          if (least < reach_mm * (1 - 1e-6)) {
            ASSERT_NEAR(found->distance_mm[index], least, 1e-6 * least) << i << ' ' << j << ' ' << k;
          }
        }
      }
}

TEST(InterfaceDistance, IsTheLeastOverAllFaces) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LabelImage image = random_image({7, 6, 5}, {0.7, 1, 2.5}, seed);
    for (const double reach : {0.8, 3.0, 100.0}) {
      expect_as_searched(image, {0, 1, 2, 0}, reach);
      expect_as_searched(image, {1, 2, 0, 2}, reach);
    }
  }
}

TEST(InterfaceDistance, TakesWhatIsOutsideForBackground) {
  const LabelImage full = image_of({3, 3, 3}, {1, 1, 1}, std::vector<LabelIndex>(27, 1));
  expect_as_searched(full, {1, 2, 0, 0}, 5);
  const auto found = interface_distances(full, {1, 2, 0, 0}, 5, 1);
  ASSERT_TRUE(found);
  EXPECT_EQ(*std::max_element(found->distance_mm.begin(), found->distance_mm.end()), 1.5F);
}

TEST(InterfaceDistance, IsNothingWhereLabelsDoNotTouch) {
  const LabelImage image = image_of({4, 1, 1}, {1, 1, 1}, {1, 0, 0, 2});
  EXPECT_FALSE(interface_distances(image, {0, 1, 2, 0}, 1, 1));
  EXPECT_TRUE(interface_distances(image, {2, 1, 0, 0}, 1, 1));
}

}  // namespace
}  // namespace podm
