// The lock contract allows an attempt the accesses that match the number of held vertices of a cell, and
// aborts on any other. Only builds with PODM_CHECK_LOCKS have it.
#include <gtest/gtest.h>

#include "delaunay/lock_contract.h"
#include "delaunay/vertex_locks.h"
#include "point_sets.h"
#include "triangulator.h"

namespace podm::test {
namespace {

class LockContract : public testing::Test {
 protected:
  LockContract() {
    for (const Point& p : random_points(3, 50, 9)) t_.insert(p);
    cell_ = t_.operation.created().front();
  }
  void TearDown() override { locks_.unlock_all(); }

  // Locks the first `num_vertices` vertices of the cell.
  void hold(CellId c, unsigned num_vertices) {
    locks_.unlock_all();
    const auto vertices = t_.mesh.peek_vertices(c);
    for (unsigned i = 0; i < num_vertices; ++i) locks_.try_lock(t_.mesh.vertex(vertices[i]));
  }
  template <class Access>
  void attempt(const Access& access) {
    const AttemptScope scope(locks_);
    access();
  }

  Triangulator t_{kBox};
  VertexLocks locks_{7};
  CellId cell_;
};

using LockContractDeathTest = LockContract;

TEST_F(LockContractDeathTest, LetsReadUnderTwoLocks) {
  const auto read = [&] { attempt([&] { t_.mesh.cell(cell_); }); };
  hold(cell_, 2);
  read();
  hold(cell_, 1);
  EXPECT_DEATH(read(), "is read with 1 of its vertices held");
  hold(cell_, 0);
  EXPECT_DEATH(read(), "is read with 0 of its vertices held");
}

TEST_F(LockContractDeathTest, LetsReadNextToACellOfTwoLocks) {
  const FacetId mirror = t_.mesh.peek_mirrors(cell_)[0];
  ASSERT_NE(mirror, kNoFacet);
  // Holds the neighbour's vertex off the common facet and one vertex on it; only one vertex of the cell
  // itself is held.
  const auto vertices = t_.mesh.peek_vertices(cell_of(mirror));
  const auto far = static_cast<unsigned>(index_in_cell(mirror));
  locks_.try_lock(t_.mesh.vertex(vertices[far]));
  locks_.try_lock(t_.mesh.vertex(vertices[(far + 1) % 4]));
  attempt([&] { t_.mesh.cell(cell_); });
}

TEST_F(LockContractDeathTest, LetsWriteMirrorsUnderThreeLocks) {
  const FacetId mirror = t_.mesh.peek_mirrors(cell_)[1];
  const auto write = [&] { attempt([&] { t_.mesh.set_mirror(4 * cell_ + 1, mirror); }); };
  hold(cell_, 3);
  write();
  hold(cell_, 2);
  EXPECT_DEATH(write(), "is given a mirror with 2 of its vertices held");
}

TEST_F(LockContractDeathTest, LetsFinishANewCellUnderThreeLocks) {
  const auto finish = [&] { attempt([&] { t_.mesh.set_mirrors(cell_, t_.mesh.peek_mirrors(cell_)); }); };
  hold(cell_, 3);
  finish();
  hold(cell_, 2);
  EXPECT_DEATH(finish(), "is given a mirror with 2 of its vertices held");
  EXPECT_DEATH(attempt([&] { t_.mesh.refresh_sphere(cell_); }), "with 2 of its vertices held");
}

TEST_F(LockContractDeathTest, LetsReplaceUnderFourLocks) {
  const auto vertices = t_.mesh.peek_vertices(cell_);
  const auto replace = [&] { attempt([&] { t_.mesh.renew(cell_, vertices); }); };
  hold(cell_, 4);
  replace();
  hold(cell_, 3);
  EXPECT_DEATH(replace(), "is replaced with 3 of its vertices held");
}

TEST_F(LockContractDeathTest, LetsNoWorkerReadWhatHasDied) {
  hold(cell_, 4);
  attempt([&] { t_.mesh.renew(cell_, {kNoVertex, kNoVertex, kNoVertex, kNoVertex}); });
  EXPECT_DEATH(attempt([&] { t_.mesh.cell(cell_); }), "is read with 0 of its vertices held");
}

TEST_F(LockContractDeathTest, KnowsTheHolderOfALock) {
  VertexLocks others(8);
  for (const VertexId v : t_.mesh.peek_vertices(cell_)) others.try_lock(t_.mesh.vertex(v));
  EXPECT_DEATH(attempt([&] { t_.mesh.cell(cell_); }), "is read with 0 of its vertices held");
  others.unlock_all();
}

TEST_F(LockContractDeathTest, BindsNoWorkerOutsideOfAnAttempt) {
  t_.mesh.set_mirror(4 * cell_ + 1, t_.mesh.cell(cell_).mirrors[1]);
}

TEST_F(LockContractDeathTest, LetsPeekAndPrefetchWithoutLocks) {
  attempt([&] {
    t_.mesh.prefetch(cell_);
    t_.mesh.prefetch_surroundings(cell_);
    t_.mesh.peek_two_vertices(cell_);
    t_.mesh.peek_center(cell_);
    t_.mesh.stamp(cell_);
  });
}

}  // namespace
}  // namespace podm::test
