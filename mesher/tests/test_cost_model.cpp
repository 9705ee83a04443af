// The prediction of a mesh's number of cells from its image, radii and delta.
#include "prediction/cost_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "podm/mesh_image.h"
#include "tests/images.h"

namespace podm::test {
namespace {

// Areas, mm^2, of label changes between voxels `lag` apart along any axis, divided by the lag. Sides with a
// label and sides of the background are summed separately, voxel by voxel. The outside is background.
struct Sides {
  double labelled = 0, outside = 0;
};
Sides sides_by_voxel(const LabelImage& image, int lag) {
  const auto label = [&](std::array<int, 3> at) -> LabelIndex {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] >= image.size[axis]) return kBackground;
    return image.voxels[image.index(at[0], at[1], at[2])];
  };
  Sides sides;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double face = image.spacing[(axis + 1) % 3] * image.spacing[(axis + 2) % 3];
    for (int k = -lag; k < image.size[2]; ++k)
      for (int j = -lag; j < image.size[1]; ++j)
        for (int i = -lag; i < image.size[0]; ++i) {
          std::array<int, 3> there{i, j, k};
          there[axis] += lag;
          const LabelIndex a = label({i, j, k}), b = label(there);
          if (a == b) continue;
          const int labelled = (a != kBackground) + (b != kBackground);
          sides.labelled += labelled * face / lag;
          sides.outside += (2 - labelled) * face / lag;
        }
  }
  return sides;
}

// The spacing of the image must be 1: one distance is then a whole number of voxels along all axes.
void expect_counts_sides(const LabelImage& image, const char* name) {
  const CostModel model(image, 1);
  double volume = 0;
  for (const LabelIndex label : image.voxels) volume += label != kBackground;
  const auto outside = [&](double delta) {
    return model.background_cells({.delta_mm = delta}) * delta * delta;
  };
  const double unit = outside(1 / 1.6) / sides_by_voxel(image, 1).outside;
  for (const int lag : {2, 3, 4, 6, 24}) {
    const Sides sides = sides_by_voxel(image, lag);
    EXPECT_NEAR(outside(lag / 1.6), unit * sides.outside, 1e-9 * unit * sides.outside) << name << ", " << lag;
    const double delta = lag / 0.8, unbounded = std::numeric_limits<double>::infinity();
    const double cells = CostModel::cells(volume, sides.labelled, unbounded, delta);
    EXPECT_NEAR(model.cells({.delta_mm = delta}), cells, 1e-9 * cells) << name << ", " << lag;
  }
}

TEST(CostModel, CountsTheSidesOfInterfacesSeenFromADistance) {
  for (const NamedImage& named : images()) {
    LabelImage image = named.make();
    image.spacing = {1, 1, 1};
    expect_counts_sides(image, named.name);
  }
}

// More voxels of a row have a side than a label can count.
TEST(CostModel, CountsTheSidesOfInterfacesInLongRows) {
  std::mt19937 random(5);
  constexpr auto kMostLabels = static_cast<int>(kMaxLabels);
  const auto long_rows = [&](int num_labels, const auto& label) {
    return make_image({40'000, 2, 2}, {1, 1, 1}, num_labels - 1, label);
  };
  const auto any_of = [&](int first, int end) {
    return first + static_cast<int>(random() % static_cast<unsigned>(end - first));
  };
  expect_counts_sides(long_rows(2, [](int, int, int) { return 1; }), "uniform");
  expect_counts_sides(long_rows(2, [](int i, int, int) { return i % 30'000 < 20'000 ? 1 : 0; }), "stretches");
  expect_counts_sides(long_rows(2, [&](int, int, int) { return any_of(0, 2); }), "random");
  expect_counts_sides(long_rows(40, [](int i, int j, int k) { return 1 + (i + 5 * j + 7 * k) % 39; }),
                      "every pair differs");
  expect_counts_sides(long_rows(kMostLabels, [&](int, int, int) { return any_of(1, kMostLabels); }),
                      "many labels");
  expect_counts_sides(
      long_rows(kMostLabels, [&](int, int, int) { return any_of(kMostLabels - 2, kMostLabels); }),
      "the largest labels");
}

// A flat cell of a coarse mesh has almost no volume for its facets, or none.
TEST(CostModel, CountsPartsOfNoVolume) {
  const double on_surface = CostModel::cells(0, 1, 2, 1);
  EXPECT_GT(on_surface, 0);
  for (const double volume : {-1e-15, 1e-300, 1e-15, 1e-12, 1e-9, 1e-6, 1e-5})
    EXPECT_NEAR(CostModel::cells(volume, 1, 2, 1), on_surface, 3 * std::max(volume, 0.0)) << volume;
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

// Larger cells, or a coarser surface, never give more cells.
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
