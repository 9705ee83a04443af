// Runs with a target number of cells meet it, and a mesh made on the way only counts as calibration.
#include "run/calibrate.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "podm/mesh_image.h"
#include "tests/images.h"

namespace podm::test {
namespace {

MeshingOptions target(std::uint64_t cells) {
  return {.sizes = {.target_elements = cells}, .team = {.threads = 1}};
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
  EXPECT_LE(calibration.meshes.size(), 2u);
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

// Returns a tolerance of a thousandth, which a first mesh misses.
MeshingOptions exact_target(std::uint64_t cells) {
  MeshingOptions options = target(cells);
  options.sizes.target_tolerance_percent = 0.1;
  return options;
}

TEST(Calibrated, MakesNoMoreMeshesThanAskedFor) {
  const LabelImage image = ball(40, 15);
  for (const int most : {1, 2}) {
    MeshingOptions options = exact_target(20'000);
    options.sizes.target_meshes = most;
    const MeshingResult made = mesh_image(image, options);
    EXPECT_LE(made.report.calibration->meshes.size() + 1, static_cast<std::size_t>(most));
    EXPECT_FALSE(made.mesh.cells.empty());
  }
}

LabelImage noise() {
  std::mt19937 random(4);
  return make_image({24, 24, 24}, {1, 1, 1}, 3,
                    [&](int, int, int) { return static_cast<int>(random() % 4); });
}

TEST(Calibration, PhasesAreThoseOfTheLastMeshAlone) {
  const auto start = std::chrono::steady_clock::now();
  const MeshingReport report = mesh_image(noise(), exact_target(120000)).report;
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const Calibration& calibration = report.calibration.value();
  ASSERT_FALSE(calibration.meshes.empty()) << "nothing to distinguish";
  EXPECT_EQ(report.phases_s.at("calibrate"), calibration.seconds);
  double meshes_s = 0;
  for (const Calibration::TrialMesh& mesh : calibration.meshes) {
    meshes_s += mesh.seconds;
    EXPECT_GT(std::abs(static_cast<double>(mesh.cells) / 120000 - 1), 0.0008);
    EXPECT_NE(mesh.radius_mm, calibration.radius_mm);
  }
  EXPECT_GT(meshes_s, 0);
  EXPECT_LE(meshes_s, calibration.seconds);
  EXPECT_LE(sum_but_calibration(report) + calibration.seconds, wall.count());
}

TEST(Calibration, VirtualSecondsAreThoseOfTheLastMeshAlone) {
  MeshingOptions options = exact_target(120000);
  options.team.threads = 8;
  options.team.executor = Executor::kVirtual;
  for (const Algorithm algorithm : {Algorithm::kPodm, Algorithm::kPdr}) {
    options.algorithm = algorithm;
    const MeshingReport found = mesh_image(noise(), options).report;
    ASSERT_FALSE(found.calibration->meshes.empty()) << "nothing to distinguish";
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
