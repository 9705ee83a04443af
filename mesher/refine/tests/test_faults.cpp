// Memory that ends, and limits that strike, at any moment of a run with any executor: all workers stop
// between operations, and the mesh is a valid triangulation.
#include <gtest/gtest.h>

#include <new>

#include "cost_model.h"
#include "failing_allocator.h"
#include "images.h"
#include "podm.h"

namespace podm::test {
namespace {

Crew crew(Executor executor, int num_workers) { return {executor, {num_workers, Contention::kLocal, {}, 3}}; }
const std::vector<Crew> kCrews{crew(Executor::kThreads, 1), crew(Executor::kThreads, 4),
                               crew(Executor::kVirtual, 6)};

class Faults : public testing::TestWithParam<Crew> {
 protected:
  Refinement refine(Watch& watch, std::size_t cell_capacity = 1 << 20) {
    return podm({isosurface_, foreground_bounds(image_), 1.2, sizes_, cell_capacity}, GetParam(), watch);
  }
  static Watch patient() {
    return {{}, {}, [](std::uint64_t) {}};
  }
  static void expect_valid(const Refinement& refinement) {
    std::string fault;
    EXPECT_TRUE(is_valid(*refinement.mesh, &fault)) << fault;
  }

  LabelImage image_ = ball(16, 6);
  Isosurface isosurface_{image_, 1};
  SizeField sizes_{std::vector<double>(2, 1.6)};
};

TEST_P(Faults, AllocationsThatFailLeaveAValidMesh) {
  int num_ended = 0, num_complete = 0;
  for (std::int64_t left = 0; num_complete < 3; left += 1 + left / 8) {
    Watch watch = patient();
    allocations_left = left;
    try {
      const Refinement refinement = refine(watch);
      const bool has_failed = allocations_left.exchange(-1) < 0;
      EXPECT_EQ(refinement.stop_reason, has_failed ? StopReason::kMemoryLimit : StopReason::kComplete)
          << left;
      num_ended += has_failed;
      num_complete += !has_failed;
      expect_valid(refinement);
    } catch (const std::bad_alloc&) {  // before the run began
      allocations_left = -1;
    }
  }
  EXPECT_GT(num_ended, 3);
}

TEST_P(Faults, StoresThatFillUpLeaveAValidMesh) {
  int num_ended = 0;
  for (std::size_t capacity = 1100; capacity < 60000; capacity += 1 + capacity / 5) {
    Watch watch = patient();
    const Refinement refinement = refine(watch, capacity);
    num_ended += refinement.stop_reason == StopReason::kMemoryLimit;
    expect_valid(refinement);
  }
  EXPECT_GT(num_ended, 5);
}

TEST_P(Faults, StopRequestsAndLimitsLeaveAValidMesh) {
  Watch whole = patient();
  const std::uint64_t all_cells = refine(whole).mesh->num_cells();
  for (std::uint64_t cells = 1; cells < all_cells; cells += 1 + cells / 2) {
    Watch limited({.max_cells = cells}, {}, [](std::uint64_t) {});
    const Refinement refinement = refine(limited);
    EXPECT_EQ(refinement.stop_reason, StopReason::kElementLimit) << cells << " of " << all_cells;
    expect_valid(refinement);
  }
  std::stop_source source;
  source.request_stop();
  Watch stopped({}, source.get_token(), [](std::uint64_t) {});
  const Refinement refinement = refine(stopped);
  EXPECT_EQ(refinement.stop_reason, StopReason::kCancelled);
  expect_valid(refinement);
  Watch late({.deadline = std::chrono::steady_clock::now()}, {}, [](std::uint64_t) {});
  EXPECT_EQ(refine(late).stop_reason, StopReason::kTimeLimit);
}

INSTANTIATE_TEST_SUITE_P(Crews, Faults, testing::ValuesIn(kCrews), [](const auto& test) {
  return to_string(test.param.executor) + std::to_string(test.param.coordination.num_workers);
});

}  // namespace
}  // namespace podm::test
