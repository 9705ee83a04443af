// Radii for a target number of cells, and their corrections.
#include "prediction/radius_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "podm/errors.h"
#include "tests/images.h"

namespace podm::test {
namespace {

const SizeOptions kAsked{.target_elements = 50000};

// The number of cells of these meshes is a power of the radius.
TEST(RadiusSearch, ComesWithinATwentiethInThreeMeshesWhateverTheModelErrs) {
  const LabelImage image = ball(40, 15);
  for (const double exponent : {-2.0, -2.5, -3.0}) {
    for (const double error : {0.3, 0.8, 1.0, 1.4, 4.0}) {
      RadiusSearch search(image, kAsked, 1);
      const double first = search.radius_mm();
      const auto cells_at = [&](double radius) { return 50000 * error * std::pow(radius / first, exponent); };
      for (int mesh = 0; mesh < 2; ++mesh) search.learn(cells_at(search.radius_mm()));
      EXPECT_NEAR(cells_at(search.radius_mm()) / 50000, 1, 0.05) << exponent << ", " << error;
    }
  }
}

// Sheets vanish where the radius passes their thickness.
TEST(RadiusSearch, FindsATargetOnASteepSlope) {
  const LabelImage image = ball(40, 15);
  RadiusSearch search(image, kAsked, 1);
  const double first = search.radius_mm();
  const auto cells_at = [&](double radius) {
    return 50000 * 1.2 * std::pow(radius / first, radius / first > 1.01 ? -12 : -2) *
           std::pow(1.01, radius / first > 1.01 ? 10 : 0);
  };
  int num_meshes = 1;
  for (; std::abs(cells_at(search.radius_mm()) / 50000 - 1) > 0.045; ++num_meshes)
    search.learn(cells_at(search.radius_mm()));
  EXPECT_LE(num_meshes, 4);
}

// No radius of the other cells can meet such a target, and a search would make ever larger meshes.
TEST(RadiusSearch, RefusesATargetBelowWhatFixedSizesAskFor) {
  const LabelImage image = ball(40, 15);
  SizeOptions sizes{.target_elements = 1000};
  const std::uint32_t value = image.labels[1].value;
  sizes.near.push_back({.labels = {{{0}, {value}}}, .radius_mm = 0.5, .width_mm = 2});
  EXPECT_THROW(RadiusSearch(image, sizes, 1), InputError);
  sizes.target_elements = 2'000'000;
  EXPECT_NO_THROW(RadiusSearch(image, sizes, 1));
  sizes = {.radius_of_mm = {{value, 0.5}}, .target_elements = 1000};
  EXPECT_THROW(RadiusSearch(image, sizes, 1), InputError);
}

// A mesh that nearly missed the object gives no information on the next mesh.
TEST(RadiusSearch, BelievesNoMeshThatIsFarOff) {
  const LabelImage image = ball(40, 15);  // outlives the search
  RadiusSearch search(image, kAsked, 1);
  const double first = search.radius_mm();
  search.learn(3);
  EXPECT_GT(search.radius_mm(), first / 3);
}

TEST(RadiusSearch, DeltaFollowsTheRadiusUnlessGiven) {
  const LabelImage image = ball(40, 15);
  const RadiusSearch free(image, kAsked, 1);
  EXPECT_EQ(free.sizes().delta_mm, free.radius_mm() / 2);
  SizeOptions sizes = kAsked;
  sizes.delta_mm = 0.7;
  EXPECT_EQ(RadiusSearch(image, sizes, 1).sizes().delta_mm, 0.7);
}

}  // namespace
}  // namespace podm::test
