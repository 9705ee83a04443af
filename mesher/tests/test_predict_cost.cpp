// Predictions for phantoms, compared with their meshes.
#include "prediction/predict_cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "podm/image_io.h"
#include "tests/fault_of.h"

namespace podm {
namespace {

class PredictedCost : public testing::TestWithParam<const char*> {};

TEST_P(PredictedCost, CellsAreWithin15Percent) {
  const LabelImage image = make_phantom(GetParam(), 96, 1);
  for (const double radius_voxels : {1.5, 3.0}) {
    MeshingOptions options;
    options.team.threads = 1;
    options.sizes.radius_mm = radius_voxels * image.spacing[0];
    options.sizes.delta_mm = options.sizes.radius_mm / 2;
    const Cost cost = predict_cost(image, options);
    const MeshingResult made = mesh_image(image, options);
    const auto cells = static_cast<double>(made.mesh.cells.size());
    EXPECT_NEAR(cost.cells / cells, 1, 0.15);
    EXPECT_NEAR(cost.stored_cells / static_cast<double>(made.report.store_cells), 1, 0.15);
    for (std::size_t i = 1; i < image.labels.size(); ++i) {
      const auto of_label = static_cast<double>(made.report.cells_of_label.at(image.labels[i].value));
      if (of_label > 5000) {
        EXPECT_NEAR(cost.cells_of_label[i] / of_label, 1, 0.5);
      }
    }
    EXPECT_GT(cost.mesh_s, 0);
    EXPECT_GT(cost.mesh_bytes, 48 * cost.stored_cells);
  }
}

TEST_P(PredictedCost, LabelsAddUpAndSizesAreThoseOfTheRun) {
  const LabelImage image = make_phantom(GetParam(), 48, 1);
  MeshingOptions options;
  options.team.threads = 1;
  options.sizes.target_elements = 30'000;
  const Cost cost = predict_cost(image, options);
  EXPECT_NEAR(cost.cells, 30'000, 60);
  EXPECT_NEAR(std::accumulate(cost.cells_of_label.begin(), cost.cells_of_label.end(), 0.0), cost.cells, 1e-6);
  EXPECT_EQ(cost.cells_of_label[kBackground], 0);
  EXPECT_DOUBLE_EQ(cost.sizes.delta_mm, cost.sizes.radius_mm / 2);
}

INSTANTIATE_TEST_SUITE_P(Phantoms, PredictedCost, testing::Values("abdomen", "spheres", "torus"));

TEST(CostOfARun, OfSenselessOptionsIsRefused) {
  const LabelImage image = make_phantom("spheres", 16, 1);
  MeshingOptions options;
  options.sizes.radius_mm = std::nan("");
  EXPECT_NE(fault_of<InputError>([&] { predict_cost(image, options); }).find("radius"), std::string::npos);
}

}  // namespace
}  // namespace podm
