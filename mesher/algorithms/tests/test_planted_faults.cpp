// The lock contract detects an operation that takes one lock too few. Only builds with PODM_CHECK_LOCKS have
// the contract.
#include <gtest/gtest.h>

#include "algorithms/podm.h"
#include "delaunay/planted_fault.h"
#include "image/foreground.h"
#include "tests/images.h"

namespace podm::test {
namespace {

class PlantedFaultDeathTest : public testing::Test {
 protected:
  void podm_with(LocksTaken locks) {
    plant_fault(locks);
    StopControl stop({}, {}, [](std::uint64_t) {});
    podm(problem_, {.executor = Executor::kVirtual, .coordination = workers_}, stop);
  }
  // Two workers per leaf. One worker makes the initial mesh and takes no locks.
  void pdr_podm_with(LocksTaken locks) {
    plant_fault(locks);
    StopControl stop({}, {}, [](std::uint64_t) {});
    pdr_podm(problem_, {.coordination = workers_, .num_nodes = 2, .initial_workers = 1}, {}, stop);
  }
  void TearDown() override { plant_fault({}); }

  CoordinationOptions workers_{.num_workers = 4, .seed = 3};
  LabelImage image_ = ball(16, 6);
  Isosurface isosurface_{image_, 1};
  Problem problem_{isosurface_, foreground_bounds(image_), 1.2, SizeField(std::vector<double>(2, 1.6)),
                   1 << 20};
};

TEST_F(PlantedFaultDeathTest, IsNoneInASoundProtocol) {
  podm_with({});
  pdr_podm_with({});
  problem_.dihedral_bounds = DihedralBounds(20, 150);
  podm_with({});
}

TEST_F(PlantedFaultDeathTest, OfNoLockToReadIsNoticed) {
  EXPECT_DEATH(podm_with({.to_read = 0}), "is read with 0 of its vertices held");
}

TEST_F(PlantedFaultDeathTest, OfOneLockToReadIsNoticed) {
  EXPECT_DEATH(podm_with({.to_read = 1}), "is read with 1 of its vertices held");
}

TEST_F(PlantedFaultDeathTest, OfThreeLocksToReplaceIsNoticed) {
  EXPECT_DEATH(podm_with({.to_replace = 3}), "is replaced with 3 of its vertices held");
}

TEST_F(PlantedFaultDeathTest, OfThreeLocksToMoveIsNoticed) {
  problem_.dihedral_bounds = DihedralBounds(20, 150);
  EXPECT_DEATH(podm_with({.to_move = 3}), "is replaced with 3 of its vertices held");
}

TEST_F(PlantedFaultDeathTest, IsNoticedInALeafToo) {
  EXPECT_DEATH(pdr_podm_with({.to_read = 1}), "is read with 1 of its vertices held");
}

}  // namespace
}  // namespace podm::test
