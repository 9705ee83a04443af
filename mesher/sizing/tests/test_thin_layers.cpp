// Deltas of plates, gaps and balls of known thickness, and their slope.
#include "sizing/thin_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "podm/errors.h"
#include "tests/images.h"

namespace podm {
namespace {

LabelImage plate(int thickness, std::array<double, 3> spacing = {1, 1, 1}) {
  return test::make_image({24, 24, 20}, spacing, 1, [=](int i, int j, int k) {
    return i > 2 && i < 21 && j > 2 && j < 21 && k >= 6 && k < 6 + thickness;
  });
}

SizeOptions keeping(double least_mm = 0) {
  SizeOptions sizes;
  sizes.thin = Thin::kKeep;
  sizes.delta_least_mm = least_mm;
  return sizes;
}

TEST(ThinLayers, APlateGetsADeltaOfItsThickness) {
  for (const int thickness : {1, 2, 3, 4}) {
    const LabelImage image = plate(thickness);
    const ThinLayers layers = find_thin_layers(image, keeping(), 8, 2);
    ASSERT_TRUE(layers.thinnest);
    EXPECT_EQ(layers.thinnest->label, 1);
    EXPECT_NEAR(layers.thinnest->thickness_mm, thickness, 0.3 * thickness);
    const double delta_mm = layers.deltas.at(image.index(12, 12, 6 + thickness / 2));
    EXPECT_LE(delta_mm, kDeltaOverThickness * thickness * 1.0001);
    EXPECT_GE(delta_mm, 0.69 * kDeltaOverThickness * thickness);
    EXPECT_EQ(layers.deltas.at(image.index(1, 1, 1)), 8);
  }
}

TEST(ThinLayers, SpacingCounts) {
  const LabelImage image = plate(1, {1, 1, 3});
  const ThinLayers layers = find_thin_layers(image, keeping(), 8, 1);
  EXPECT_NEAR(layers.deltas.at(image.index(12, 12, 6)), 2.1, 1e-5);
}

TEST(ThinLayers, AGapOfTheBackgroundIsALayer) {
  const LabelImage image = test::make_image({20, 20, 20}, {1, 1, 1}, 1, [](int i, int j, int k) {
    return i > 2 && i < 17 && j > 2 && j < 17 && k > 2 && k < 17 && i != 9;
  });
  const ThinLayers layers = find_thin_layers(image, keeping(), 3, 1);
  ASSERT_TRUE(layers.thinnest);
  EXPECT_EQ(layers.thinnest->label, kBackground);
  EXPECT_NEAR(layers.deltas.at(image.index(9, 9, 9)), 0.7, 1e-5);
}

TEST(ThinLayers, ABallHasNone) {
  for (const double delta_mm : {0.5, 1.0, 2.0, 3.0})
    EXPECT_EQ(find_thin_layers(test::ball(30, 11), keeping(), delta_mm, 1).num_voxels, 0u) << delta_mm;
}

TEST(ThinLayers, NoFieldIsSteeperThanItsSlope) {
  for (const std::array<double, 3>& spacing :
       {std::array<double, 3>{1, 1, 1}, std::array<double, 3>{0.5, 1, 2.5}}) {
    const LabelImage image = plate(1, spacing);
    ThinLayers layers = find_thin_layers(image, keeping(), 4, 1);
    for (std::size_t n = 0; n < 20; ++n) layers.deltas.lower(n * 397, 0.3 + 0.1 * static_cast<double>(n));
    const auto field = layers.deltas.graded();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-4, 26), step(-1, 1);
    for (int n = 0; n < 20000; ++n) {
      const Point p{place(random) * spacing[0] - 7, place(random) * spacing[1] + 11,
                    place(random) * spacing[2] + 3};
      const Point q = p + Vector{step(random), step(random), step(random)};
      const double a = field->at(p), b = field->at(q);
      ASSERT_LE(std::fabs(a - b), DeltaField::kSlope * distance(p, q) + 1e-6 * a);
      ASSERT_GE(a, field->least_mm() * (1 - 1e-6));
      ASSERT_LE(a, field->most_mm() * (1 + 1e-6));
      ASSERT_GE(b * (1 + 1e-6), field->least_within(distance(p, q), a));
    }
  }
}

TEST(ThinLayers, DeltasAreLoweredToTheLeast) {
  const LabelImage image = plate(1);
  DeltasAtVoxels deltas(image, 0.5, 2);
  EXPECT_TRUE(deltas.lower(7, 0.1));
  EXPECT_EQ(deltas.at(7), 0.5);
  EXPECT_FALSE(deltas.lower(7, 0.1));
  EXPECT_FALSE(deltas.lower(8, 3));
}

TEST(ThinLayers, SharesOfInterfacesAreByDelta) {
  const LabelImage image = plate(2);
  DeltasAtVoxels deltas(image, 0.5, 2);
  double sum = 0;
  for (const auto& [delta_mm, share] : shares_of_deltas(image, deltas)) sum += delta_mm * share;
  EXPECT_NEAR(sum, 2, 1e-9);
}

}  // namespace
}  // namespace podm
