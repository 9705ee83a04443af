// Radii for a target number of cells: what they are predicted from, how they are corrected, and that a mesh
// made on the way counts in nothing but calibration.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numeric>

#include "cost_model.h"
#include "images.h"
#include "podm/mesh_image.h"
#include "radius_search.h"

namespace podm::test {
namespace {

MeshingOptions target(std::uint64_t cells) {
  return {.sizes = {.target_elements = cells}, .team = {.threads = 1}};
}

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

// Meshes whose cells follow some power of the radius.
TEST(RadiusSearch, ComesWithinATwentiethInThreeMeshesWhateverTheModelErrs) {
  const LabelImage image = ball(40, 15);
  for (const double exponent : {-2.0, -2.5, -3.0}) {
    for (const double error : {0.3, 0.8, 1.0, 1.4, 4.0}) {
      RadiusSearch search(image, target(50000).sizes, 1);
      const double first = search.radius_mm();
      const auto cells_at = [&](double radius) { return 50000 * error * std::pow(radius / first, exponent); };
      for (int mesh = 0; mesh < 2; ++mesh) search.learn(cells_at(search.radius_mm()));
      EXPECT_NEAR(cells_at(search.radius_mm()) / 50000, 1, 0.05) << exponent << ", " << error;
    }
  }
}

// Sheets that vanish where the radius passes their thickness.
TEST(RadiusSearch, FindsATargetOnASteepSlope) {
  const LabelImage image = ball(40, 15);
  RadiusSearch search(image, target(50000).sizes, 1);
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

TEST(RadiusSearch, DeltaFollowsTheRadiusUnlessGiven) {
  const LabelImage image = ball(40, 15);
  const RadiusSearch free(image, target(50000).sizes, 1);
  EXPECT_EQ(free.sizes().delta_mm, free.radius_mm() / 2);
  SizeOptions sizes = target(50000).sizes;
  sizes.delta_mm = 0.7;
  EXPECT_EQ(RadiusSearch(image, sizes, 1).sizes().delta_mm, 0.7);
}

double sum_but_calibration(const MeshingReport& report) {
  double seconds = 0;
  for (const auto& [phase, phase_s] : report.phases_s)
    if (phase != "calibrate") seconds += phase_s;
  return seconds;
}

class Calibrated : public testing::TestWithParam<std::uint64_t> {};

TEST_P(Calibrated, MeetsTheTargetWithTheMeshOfTheRadiusThatItNames) {
  const LabelImage image = ball(40, 15);
  const MeshingResult found = mesh_image(image, target(GetParam()));
  ASSERT_TRUE(found.report.calibration);
  const Calibration& calibration = *found.report.calibration;
  EXPECT_NEAR(static_cast<double>(found.mesh.cells.size()), static_cast<double>(GetParam()),
              0.05 * static_cast<double>(GetParam()));
  EXPECT_LE(calibration.meshes.size(), 1u);
  EXPECT_EQ(calibration.target_elements, GetParam());
  EXPECT_EQ(calibration.radius_mm, found.report.radius_mm);
  EXPECT_TRUE(found.report.warnings.empty());
  const MeshingOptions again{.sizes = {.radius_mm = calibration.radius_mm, .delta_mm = found.report.delta_mm},
                             .team = {.threads = 1}};
  const MeshingResult made = mesh_image(image, again);
  EXPECT_EQ(made.mesh.cells, found.mesh.cells);
  EXPECT_EQ(made.mesh.vertices, found.mesh.vertices);
  EXPECT_FALSE(made.report.calibration);
  EXPECT_FALSE(made.report.phases_s.contains("calibrate"));
}

INSTANTIATE_TEST_SUITE_P(Targets, Calibrated, testing::Values(5000, 20000, 100000));

// An image whose first mesh misses: noise, unlike what the model was fitted to.
LabelImage noise() {
  std::mt19937 random(4);
  return make_image({24, 24, 24}, {1, 1, 1}, 3,
                    [&](int, int, int) { return static_cast<int>(random() % 4); });
}

TEST(Calibration, PhasesAreThoseOfTheLastMeshAlone) {
  const auto start = std::chrono::steady_clock::now();
  const MeshingReport report = mesh_image(noise(), target(120000)).report;
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const Calibration& calibration = report.calibration.value();
  ASSERT_FALSE(calibration.meshes.empty()) << "nothing to tell apart";
  EXPECT_EQ(report.phases_s.at("calibrate"), calibration.seconds);
  double meshes_s = 0;
  for (const Calibration::TrialMesh& mesh : calibration.meshes) {
    meshes_s += mesh.seconds;
    EXPECT_GT(std::abs(static_cast<double>(mesh.cells) / 120000 - 1), 0.04);
    EXPECT_NE(mesh.radius_mm, calibration.radius_mm);
  }
  EXPECT_GT(meshes_s, 0);
  EXPECT_LE(meshes_s, calibration.seconds);
  EXPECT_LE(sum_but_calibration(report) + calibration.seconds, wall.count());
}

TEST(Calibration, VirtualSecondsAreThoseOfTheLastMeshAlone) {
  MeshingOptions options = target(120000);
  options.team.threads = 8;
  options.team.executor = Executor::kVirtual;
  for (const Algorithm algorithm : {Algorithm::kPodm, Algorithm::kPdr}) {
    options.algorithm = algorithm;
    const MeshingReport found = mesh_image(noise(), options).report;
    ASSERT_FALSE(found.calibration->meshes.empty()) << "nothing to tell apart";
    MeshingOptions again = options;
    again.sizes.target_elements = 0;
    again.sizes.radius_mm = found.radius_mm;
    again.sizes.delta_mm = found.delta_mm;
    const MeshingReport made = mesh_image(noise(), again).report;
    EXPECT_EQ(found.virtual_phases_s, made.virtual_phases_s);
    EXPECT_EQ(made.virtual_phases_s.contains("initial"), algorithm == Algorithm::kPdr);
    EXPECT_GT(made.virtual_phases_s.at("refine"), 0);
  }
}

TEST(Calibration, IsTheSameEachTimeOnOneThread) {
  const MeshingResult first = mesh_image(noise(), target(30000)), second = mesh_image(noise(), target(30000));
  EXPECT_EQ(first.report.calibration->radius_mm, second.report.calibration->radius_mm);
  EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
}

TEST(Calibration, WarnsWhereATargetCannotBeMet) {
  MeshingOptions options = target(300);
  options.sizes.delta_mm = 0.8;  // the surface alone takes more
  const MeshingResult result = mesh_image(ball(24, 9), options);
  EXPECT_EQ(result.report.warnings.size(), 1u);
  EXPECT_TRUE(result.report.guarantees.all_met());
  EXPECT_GT(result.mesh.cells.size(), 1000u);
  EXPECT_TRUE(std::isfinite(result.report.radius_mm));
  EXPECT_LE(result.report.calibration->meshes.size(), 1u) << "no radius changes anything";
}

TEST(Calibration, EndsWithinTheToleranceThatWasAskedFor) {
  MeshingOptions options = target(120000);
  options.sizes.target_tolerance_percent = 100;
  EXPECT_TRUE(mesh_image(noise(), options).report.calibration->meshes.empty());
  options.sizes.target_tolerance_percent = 1;
  const MeshingResult near = mesh_image(noise(), options);
  EXPECT_NEAR(static_cast<double>(near.mesh.cells.size()), 120000, 1200);
  EXPECT_TRUE(near.report.warnings.empty());
}

TEST(Calibration, LimitsHold) {
  MeshingOptions elements = target(200000), time = target(20000000), memory = target(200000);
  elements.limits.max_elements = 10000;
  time.limits.max_seconds = 0.2;
  memory.limits.max_memory_bytes = 1 << 20;
  EXPECT_EQ(mesh_image(ball(40, 15), elements).report.stop_reason, StopReason::kElementLimit);
  EXPECT_EQ(mesh_image(ball(40, 15), time).report.stop_reason, StopReason::kTimeLimit);
  EXPECT_EQ(mesh_image(ball(40, 15), memory).report.stop_reason, StopReason::kMemoryLimit);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(mesh_image(ball(40, 15), target(200000), {}, stop.get_token()).report.stop_reason,
            StopReason::kCancelled);
}

}  // namespace
}  // namespace podm::test
