// The prediction of a mesh's number of cells from its image, radii and delta.
#include "cost_model.h"

#include <gtest/gtest.h>

#include "podm/mesh_image.h"
#include "tests/images.h"

namespace podm::test {
namespace {

// Sides, with a label, of label changes between voxels `lag` apart along any axis, over the lag: areas in
// voxel faces. Voxel by voxel, and outside all is background.
double sides_by_voxel(const LabelImage& image, int lag) {
  const auto label = [&](std::array<int, 3> at) -> LabelIndex {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] >= image.size[axis]) return kBackground;
    return image.voxels[image.index(at[0], at[1], at[2])];
  };
  double sides = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double face = image.spacing[(axis + 1) % 3] * image.spacing[(axis + 2) % 3];
    for (int k = -lag; k < image.size[2]; ++k)
      for (int j = -lag; j < image.size[1]; ++j)
        for (int i = -lag; i < image.size[0]; ++i) {
          std::array<int, 3> there{i, j, k};
          there[axis] += lag;
          const LabelIndex a = label({i, j, k}), b = label(there);
          if (a != b) sides += face * ((a != kBackground) + (b != kBackground)) / lag;
        }
  }
  return sides;
}

// Unbounded radii leave the interfaces' share.
double surface_cells(const LabelImage& image, double delta_mm, int threads = 1) {
  return CostModel(image, threads).cells({.delta_mm = delta_mm});
}

TEST(CostModel, CountsTheSidesOfInterfacesSeenFromADistance) {
  for (const NamedImage& named : images()) {
    LabelImage image = named.make();
    image.spacing = {1, 1, 1};  // so that one distance is a whole number of voxels along all axes
    const double unit = surface_cells(image, 1 / 1.6) / sides_by_voxel(image, 1) / (1.6 * 1.6);
    for (const int lag : {2, 3, 4, 6, 24}) {
      const double delta = lag / 1.6;
      EXPECT_NEAR(surface_cells(image, delta) * delta * delta, unit * sides_by_voxel(image, lag), 1e-9)
          << named.name << ", " << lag;
    }
  }
}

TEST(CostModel, FindsTheSameOnAnyNumberOfThreads) {
  for (const NamedImage& named : images()) {
    const LabelImage image = named.make();
    for (const double delta : {0.5, 2.2, 30.0})
      EXPECT_EQ(surface_cells(image, delta), surface_cells(image, delta, 5)) << named.name;
  }
}

TEST(CostModel, FollowsVolumeAndRadiiOfLabels) {
  const LabelImage image =
      make_image({60, 60, 60}, {1, 1, 1}, 2, [](int i, int, int) { return i < 30 ? 1 : 2; });
  const auto cells = [&](double radius, double radius_of_20) {
    SizeOptions sizes{.radius_mm = radius, .delta_mm = 0.5};
    if (radius_of_20 > 0) sizes.radius_of_mm[20] = radius_of_20;
    return CostModel(image, 1).cells(sizes) - surface_cells(image, 0.5);
  };
  EXPECT_GT(cells(1, 0), 7 * cells(2, 0)) << "volume counts by the third power";
  EXPECT_NEAR(cells(1, 2), (cells(1, 0) + cells(2, 0)) / 2, 1e-6) << "each label by its own radius";
  EXPECT_EQ(cells(1000, 0), 0) << "what is thinner than the radius has no core";
}

}  // namespace
}  // namespace podm::test
