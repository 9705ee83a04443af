// The prediction of a mesh's number of cells from its image, radii and delta.
#include "cost_model.h"

#include <gtest/gtest.h>

#include <limits>

#include "podm/mesh_image.h"
#include "tests/images.h"

namespace podm::test {
namespace {

// Label changes between background and others, of voxels `lag` apart along any axis, over the lag: areas in
// voxel faces. Voxel by voxel, and outside all is background.
double outside_by_voxel(const LabelImage& image, int lag) {
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
          if ((label({i, j, k}) == kBackground) != (label(there) == kBackground)) sides += face / lag;
        }
  }
  return sides;
}

TEST(CostModel, CountsTheSidesOfInterfacesSeenFromADistance) {
  for (const NamedImage& named : images()) {
    LabelImage image = named.make();
    image.spacing = {1, 1, 1};  // so that one distance is a whole number of voxels along all axes
    const CostModel model(image, 1);
    const auto outside = [&](double delta) {
      return model.background_cells({.delta_mm = delta}) * delta * delta;
    };
    const double unit = outside(1 / 1.6) / outside_by_voxel(image, 1);
    for (const int lag : {2, 3, 4, 6, 24})
      EXPECT_NEAR(outside(lag / 1.6), unit * outside_by_voxel(image, lag), 1e-9) << named.name << ", " << lag;
  }
}

TEST(CostModel, FindsTheSameOnAnyNumberOfThreads) {
  for (const NamedImage& named : images()) {
    const LabelImage image = named.make();
    for (const double delta : {0.5, 2.2, 30.0})
      EXPECT_EQ(CostModel(image, 1).cells({.delta_mm = delta}),
                CostModel(image, 5).cells({.delta_mm = delta}))
          << named.name;
  }
}

TEST(CostModel, FollowsVolumeAndRadiiOfLabels) {
  const LabelImage image =
      make_image({60, 60, 60}, {1, 1, 1}, 2, [](int i, int, int) { return i < 30 ? 1 : 2; });
  const CostModel model(image, 1);
  const auto cells = [&](double radius, double radius_of_20, double delta) {
    SizeOptions sizes{.radius_mm = radius, .delta_mm = delta};
    if (radius_of_20 > 0) sizes.radius_of_mm[20] = radius_of_20;
    return model.cells(sizes);
  };
  EXPECT_NEAR(cells(0.25, 0, 2) / cells(0.5, 0, 2), 8, 0.1) << "volume counts by the third power";
  for (const double delta : {0.25, 0.5, 1.0, 2.0})
    EXPECT_NEAR(cells(1, 2, delta), (cells(1, 0, delta) + cells(2, 0, delta)) / 2, 1e-6)
        << "each label by its own radius";
  EXPECT_EQ(cells(1000, 0, 0.5), cells(0, 0, 0.5)) << "what is thinner than the radius has no core";
}

// Larger cells, or a coarser surface, are never more.
TEST(CostModel, FallsAsRadiusAndDeltaGrow) {
  for (const NamedImage& named : images()) {
    const LabelImage image = named.make();
    const CostModel model(image, 1);
    double before = std::numeric_limits<double>::infinity();
    for (double radius = 0.3; radius < 1e4; radius *= 1.3) {
      const double cells = model.cells({.radius_mm = radius, .delta_mm = radius / 2});
      EXPECT_LE(cells, before * 1.0000001) << named.name << ", " << radius;
      before = cells;
    }
    before = std::numeric_limits<double>::infinity();
    for (double delta = 0.3; delta < 1e3; delta *= 1.3) {
      const double cells = model.cells({.radius_mm = 5, .delta_mm = delta});
      EXPECT_LE(cells, before * 1.0000001) << named.name << ", " << delta;
      before = cells;
    }
  }
}

}  // namespace
}  // namespace podm::test
