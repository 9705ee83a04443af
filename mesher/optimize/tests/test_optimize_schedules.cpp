// Seeded schedules of optimising workers that continue in the middle of each other's attempts
// (delaunay/step.h). All end in a valid mesh, but not with a fault planted in the lock protocol.
// $PODM_SCHEDULES: the number of each kind.
#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "algorithms/tests/in_own_process.h"
#include "delaunay/planted_fault.h"
#include "delaunay/tests/validity.h"
#include "optimize/tests/optimized_mesh.h"

namespace podm::test {
namespace {

constexpr unsigned kMostSeconds = 20;  // limit of a schedule
constexpr int kSound = 60, kMostToFind = 2000;

int num_schedules(int otherwise) {
  const char* const asked = std::getenv("PODM_SCHEDULES");
  return asked != nullptr ? std::stoi(asked) : otherwise;
}

class OptimizeSchedules : public testing::Test {
 protected:
  ~OptimizeSchedules() override { plant_fault({}); }

  // Bad cells are side by side in such a small mesh, so workers meet.
  static MeshToOptimize mesh_of(int seed) {
    if (seed % 2 == 0) return {ball(12, 5), 1.8, 1};
    return {make_image({9, 9, 9}, {1, 1, 1}, 3, [](int i, int j, int) { return i < 4 ? 1 : 2 + j / 5; }), 1.8,
            1};
  }

  // Returns the fault of the mesh that a schedule leaves, or nothing if the mesh is correct.
  static std::string fault_of(int seed) try {
    MeshToOptimize optimized = mesh_of(seed);
    const auto facets = optimized.interface_facets();
    const double worst = optimized.worst_quality();
    StopControl stop({}, {}, [](std::uint64_t) {});
    const OptimizationReport report =
        optimized.optimize(Executor::kVirtual, 2 + seed % 7, static_cast<std::uint64_t>(seed), stop);
    std::string fault;
    if (stop.reason() != StopReason::kComplete) return "the run is not complete";
    if (!is_triangulation(optimized.mesh(), &fault)) return fault;
    if (optimized.num_over_bounds() > 0) return "a cell breaks a bound";
    if (optimized.worst_quality() < worst) return "the worst cell is worse";
    if (optimized.num_beyond(kBounds) != report.beyond_bounds) return "the report is wrong";
    if (report.successes.at(OptimizationMeans::kPeels) == 0 && optimized.interface_facets() != facets)
      return "an interface has changed";
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }

  // True if the planted fault shows in a schedule.
  static bool is_found_in(int seed) {
    return fails_in_own_process(kMostSeconds, [&] { return !fault_of(seed).empty(); });
  }

  static void expect_found() {
    for (int seed = 0; seed < num_schedules(kMostToFind); ++seed)
      if (is_found_in(seed)) return;
    ADD_FAILURE() << "not found";
  }
};

TEST_F(OptimizeSchedules, AllLeaveASoundMesh) {
  for (int seed = 0; seed < num_schedules(kSound); ++seed) EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

TEST_F(OptimizeSchedules, FindThatThreeLocksAreTooFewInACavity) {
  plant_fault({.in_cavity = 3});
  expect_found();
}

TEST_F(OptimizeSchedules, RepeatForTheSameSeed) {
  for (int seed = 0; seed < 4; ++seed) {
    std::vector<std::array<double, 13>> content[2];
    for (auto& of_run : content) {
      MeshToOptimize optimized = mesh_of(seed);
      StopControl stop({}, {}, [](std::uint64_t) {});
      optimized.optimize(Executor::kVirtual, 4, static_cast<std::uint64_t>(seed), stop);
      of_run = optimized.content();
    }
    EXPECT_EQ(content[0], content[1]) << "seed " << seed;
  }
}

}  // namespace
}  // namespace podm::test
