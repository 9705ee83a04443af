// An optimised mesh keeps its properties and its cells are better, for any number of workers, and wherever
// they stop.
#include "delaunay/tests/validity.h"
#include "optimize/optimize_mesh.h"

#include <gtest/gtest.h>

#include <set>

#include "optimize/tests/optimized_mesh.h"

namespace podm::test {
namespace {

struct Workers {
  Executor executor;
  int number;
};
constexpr std::array kWorkers{Workers{Executor::kThreads, 1}, Workers{Executor::kThreads, 4},
                              Workers{Executor::kVirtual, 6}};

MeshToOptimize small_mesh(const NamedImage& image) { return {image.make(), 1.8, 1.1}; }

void expect_sound(const MeshToOptimize& optimized, Mesh& mesh) {
  std::string fault;
  EXPECT_TRUE(is_triangulation(mesh, &fault)) << fault;
  EXPECT_EQ(optimized.num_over_bounds(), 0);
}

class OptimizeMesh : public testing::TestWithParam<NamedImage> {};

TEST_P(OptimizeMesh, KeepsBoundsAndSurfacesAndBettersCells) {
  for (const auto& [executor, number] : kWorkers) {
    SCOPED_TRACE(to_string(executor) + " " + std::to_string(number));
    MeshToOptimize optimized = small_mesh(GetParam());
    const auto facets = optimized.interface_facets();
    const auto volumes = optimized.volumes();
    const double worst = optimized.worst_quality();
    const std::uint64_t beyond = optimized.num_beyond(kBounds);
    const std::uint64_t beyond_aim = optimized.num_beyond(optimized.parameters().aim.bounds());
    StopControl stop({}, {}, [](std::uint64_t) {});
    const OptimizationReport report = optimized.optimize(executor, number, 1, stop);
    expect_sound(optimized, optimized.mesh());
    EXPECT_GE(optimized.worst_quality(), worst);
    EXPECT_EQ(report.beyond_bounds_before, beyond);
    EXPECT_EQ(report.beyond_aim_before, beyond_aim);
    EXPECT_EQ(report.beyond_bounds, optimized.num_beyond(kBounds));
    EXPECT_EQ(report.beyond_aim, optimized.num_beyond(optimized.parameters().aim.bounds()));
    EXPECT_LE(10 * report.beyond_bounds, beyond + 10);
    std::uint64_t num_obstacles = 0;
    for (const auto& [obstacle, count] : report.obstacles) num_obstacles += count;
    EXPECT_EQ(num_obstacles, report.beyond_bounds);
    // A peel swaps some facets of one cell.
    const auto facets_after = optimized.interface_facets();
    std::uint64_t num_gone = 0, num_new = 0;
    for (const auto& facet : facets) num_gone += !facets_after.contains(facet.first);
    for (const auto& facet : facets_after) num_new += !facets.contains(facet.first);
    const std::uint64_t num_peels = report.successes.at(OptimizationMeans::kPeels);
    EXPECT_LE(num_gone, 4 * num_peels);
    EXPECT_LE(num_new, 2 * num_peels);
    if (num_peels > 0) continue;
    EXPECT_EQ(facets_after, facets);
    for (std::size_t label = 1; label < volumes.size(); ++label)
      EXPECT_NEAR(optimized.volumes()[label], volumes[label], 1e-12 * volumes[label]);
  }
}

TEST_P(OptimizeMesh, IsTheSameEveryTimeByOneWorker) {
  MeshToOptimize first = small_mesh(GetParam()), second = small_mesh(GetParam());
  for (MeshToOptimize* optimized : {&first, &second}) {
    StopControl stop({}, {}, [](std::uint64_t) {});
    optimized->optimize(Executor::kThreads, 1, 1, stop);
  }
  EXPECT_EQ(first.content(), second.content());
}

TEST_P(OptimizeMesh, DoesNothingTheSecondTimeThatMakesItWorse) {
  MeshToOptimize optimized = small_mesh(GetParam());
  StopControl stop({}, {}, [](std::uint64_t) {});
  optimized.optimize(Executor::kThreads, 1, 1, stop);
  const double worst = optimized.worst_quality();
  const OptimizationReport again = optimized.optimize(Executor::kThreads, 1, 1, stop);
  EXPECT_LE(again.beyond_bounds, again.beyond_bounds_before);
  EXPECT_GE(optimized.worst_quality(), worst);
}

INSTANTIATE_TEST_SUITE_P(Images, OptimizeMesh, testing::ValuesIn(images()),
                         [](const auto& image) { return std::string(image.param.name); });

TEST(OptimizeMeshUntilStopped, LeavesASoundMeshThatIsNoWorse) {
  for (const auto& [executor, number] : kWorkers) {
    for (int after = 0; after < 40; after += 7) {
      MeshToOptimize optimized(ball(20, 8), 1.5, 1.1);
      const double worst = optimized.worst_quality();
      std::stop_source source;
      StopControl stop({}, source.get_token(), [](std::uint64_t) {});
      std::jthread stopper([&] {
        std::this_thread::sleep_for(std::chrono::microseconds(100 * after));
        source.request_stop();
      });
      const OptimizationReport report = optimized.optimize(executor, number, 1, stop);
      stopper.join();
      expect_sound(optimized, optimized.mesh());
      EXPECT_GE(optimized.worst_quality(), worst);
      EXPECT_EQ(report.beyond_bounds, optimized.num_beyond(kBounds))
          << "cells that are listed still are counted";
    }
  }
}

TEST(OptimizeMeshUntilStopped, ChangesNothingWhenItIsOverAlready) {
  MeshToOptimize optimized(ball(16, 6), 1.5, 1.1);
  const auto before = optimized.content();
  StopControl stop({}, {}, [](std::uint64_t) {});
  stop.end(StopReason::kTimeLimit);
  optimized.optimize(Executor::kThreads, 1, 1, stop);
  EXPECT_EQ(optimized.content(), before);
}

}  // namespace
}  // namespace podm::test
