// Vertex locks: which worker holds which vertex.
#include <gtest/gtest.h>

#include "delaunay/vertex_locks.h"

namespace podm::test {
namespace {

TEST(VertexLocks, HoldWhatWasLockedUntilAllIsUnlocked) {
  std::array<Vertex, 3> vertices;
  VertexLocks mine(4), others(5);
  EXPECT_EQ(mine.try_lock(vertices[0]), StepResult::kDone);
  EXPECT_EQ(others.try_lock(vertices[1]), StepResult::kDone);
  EXPECT_TRUE(mine.holds(vertices[0]));
  EXPECT_FALSE(mine.holds(vertices[1]));
  EXPECT_FALSE(mine.holds(vertices[2]));
  mine.unlock_all();
  EXPECT_FALSE(mine.holds(vertices[0]));
  EXPECT_TRUE(others.holds(vertices[1]));
}

TEST(VertexLocks, NameTheHolderOfALockThatTheyCannotTake) {
  Vertex vertex;
  VertexLocks mine(4), others(5);
  others.try_lock(vertex);
  EXPECT_EQ(mine.try_lock(vertex), StepResult::kLockConflict);
  EXPECT_EQ(mine.conflicting_worker(), 5u);
  EXPECT_FALSE(mine.holds(vertex));
  EXPECT_EQ(others.try_lock(vertex), StepResult::kDone) << "held from before";
}

}  // namespace
}  // namespace podm::test
