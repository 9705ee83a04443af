// Locks that are confined to the region of a leaf: the vertices that they lock, and those that they hold.
#include "algorithms/leaf_locks.h"

#include <gtest/gtest.h>

namespace podm::test {
namespace {

constexpr double kSide = 8;

Vertex vertex_at(double x) { return {{x, 0.5, 0.5}, 0, 0, VertexKind::kCircumcenter}; }

// Leaves with a side of 1; the region of the first ends at 2.
class LeafLocksTest : public testing::Test {
 protected:
  Octree octree_{{0, 0, 0},
                 {kSide, kSide, kSide},
                 1,
                 [](const Point&, const Point&) { return 1.0; },
                 [](const Point&, const Point&) { return true; }};
  LeafRegion region_{octree_, octree_.leaf_at({0.5, 0.5, 0.5})};
  Vertex inside_ = vertex_at(1.5), outside_ = vertex_at(2.5);
};

TEST_F(LeafLocksTest, HoldWhatIsLockedInTheRegion) {
  LeafLocks<VertexLocks> locks(3);
  locks.confine(region_);
  EXPECT_FALSE(locks.holds(inside_));
  EXPECT_EQ(locks.try_lock(inside_), StepResult::kDone);
  EXPECT_TRUE(locks.holds(inside_));
  EXPECT_EQ(locks.try_lock(outside_), StepResult::kOutOfReach);
  EXPECT_FALSE(locks.holds(outside_));
  locks.unlock_all();
  EXPECT_FALSE(locks.holds(inside_));
}

TEST_F(LeafLocksTest, OfOneWorkerHoldAllThatIsInTheRegion) {
  LeafLocks<NoLocks> locks(3);
  locks.confine(region_);
  EXPECT_TRUE(locks.holds(inside_));
  EXPECT_EQ(locks.try_lock(outside_), StepResult::kOutOfReach);
  EXPECT_FALSE(locks.holds(outside_));
}

}  // namespace
}  // namespace podm::test
