// The lock contract detects an optimisation that takes one lock too few. Only builds with PODM_CHECK_LOCKS
// have the contract.
#include <gtest/gtest.h>

#include "delaunay/planted_fault.h"
#include "optimize/tests/optimized_mesh.h"

namespace podm::test {
namespace {

class OptimizePlantedFaultDeathTest : public testing::Test {
 protected:
  void optimize_with(LocksTaken locks) {
    plant_fault(locks);
    StopControl stop({}, {}, [](std::uint64_t) {});
    optimized_.optimize(Executor::kVirtual, 4, 3, stop);
  }
  void TearDown() override { plant_fault({}); }

  MeshToOptimize optimized_{ball(16, 6), 1.6, 1.2};
};

TEST_F(OptimizePlantedFaultDeathTest, IsNoneInASoundProtocol) { optimize_with({}); }

TEST_F(OptimizePlantedFaultDeathTest, OfOneLockToReadIsNoticed) {
  EXPECT_DEATH(optimize_with({.to_read = 1}), "is read with 1 of its vertices held");
}

TEST_F(OptimizePlantedFaultDeathTest, OfThreeLocksInACavityIsNoticed) {
  EXPECT_DEATH(optimize_with({.in_cavity = 3}), "is replaced with 3 of its vertices held");
}

}  // namespace
}  // namespace podm::test
