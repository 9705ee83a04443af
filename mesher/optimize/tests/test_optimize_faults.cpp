// Memory that runs out at any moment of an optimisation leaves a valid mesh that is no worse.
#include <gtest/gtest.h>

#include "algorithms/tests/failing_allocator.h"
#include "delaunay/tests/cells_by_points.h"
#include "delaunay/tests/validity.h"
#include "optimize/tests/optimized_mesh.h"

namespace podm::test {
namespace {

TEST(OptimizationFaults, OfMemoryLeaveASoundMesh) {
  for (const auto& [executor, num_workers] :
       {std::pair{Executor::kThreads, 1}, {Executor::kThreads, 4}, {Executor::kVirtual, 6}}) {
    for (int after = 0; after < 200; after = 2 * after + 1) {
      MeshToOptimize optimized(
          make_image({12, 12, 12}, {1, 1, 1}, 2, [](int i, int, int) { return i < 6 ? 1 : 2; }), 1.5, 1);
      const double worst = optimized.worst_quality();
      const auto cells_before = cells_by_points(optimized.mesh());
      StopControl stop({}, {}, [](std::uint64_t) {});
      allocations_left = after;
      bool is_thrown = false;
      try {
        optimized.optimize(executor, num_workers, 1, stop);
      } catch (const std::bad_alloc&) {
        is_thrown = true;
      }
      const bool has_failed = allocations_left.exchange(-1) < 0;
      EXPECT_EQ(stop.reason(), has_failed && !is_thrown ? StopReason::kMemoryLimit : StopReason::kComplete);
      if (is_thrown) {
        EXPECT_EQ(cells_by_points(optimized.mesh()), cells_before);
      }
      std::string fault;
      EXPECT_TRUE(is_triangulation(optimized.mesh(), &fault)) << fault;
      EXPECT_EQ(optimized.num_over_bounds(), 0);
      EXPECT_GE(optimized.worst_quality(), worst);
      for (VertexId v = 0; v < optimized.mesh().vertex_bound(); ++v)
        ASSERT_EQ(optimized.mesh().vertex(v).lock, 0) << "of vertex " << v;
    }
  }
}

}  // namespace
}  // namespace podm::test
