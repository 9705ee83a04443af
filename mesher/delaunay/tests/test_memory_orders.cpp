// Tests of each memory order by which one thread sees what another has written: a thread writes plain data,
// then makes the access that publishes it; another thread makes the access that reads the publication, then
// reads the data. Without the order the second thread has a data race, which the thread sanitizer finds on
// any processor. ci/race.sh plants each order as relaxed (delaunay/planted_fault.h) and requires that it is
// found.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <thread>

#include "delaunay/mesh.h"
#include "delaunay/vertex_locks.h"

namespace podm::test {
namespace {

constexpr Box kBox{{0, 0, 0}, {1, 1, 1}};
constexpr int kRounds = 200;

// Runs both at once. jthread's start and end order everything else.
void run_both(const std::function<void()>& one, const std::function<void()>& other) {
  const std::jthread thread(one);
  other();
}

void wait_until(const std::function<bool()>& is_true) {
  while (!is_true()) std::this_thread::yield();
}

TEST(MemoryOrders, TheNextHolderOfALockSeesWhatTheLastHolderWrote) {
  Vertex vertex;
  int sum = 0;
  const auto add_as = [&](WorkerId self) {
    VertexLocks locks(self);
    for (int i = 0; i < kRounds; ++i) {
      wait_until([&] { return locks.try_lock(vertex) == StepResult::kDone; });
      ++sum;
      locks.unlock_all();
      std::this_thread::yield();
    }
  };
  run_both([&] { add_as(0); }, [&] { add_as(1); });
  EXPECT_EQ(sum, 2 * kRounds);
}

// A coordinate of the new point shows what was written before place(): the deaths of the old point's cells.
class EachCoordinate : public testing::TestWithParam<std::size_t> {};

TEST_P(EachCoordinate, OfANewPointShowsWhatWasWrittenBefore) {
  const auto coordinate = std::array{&Point::x, &Point::y, &Point::z}[GetParam()];
  for (int round = 0; round < kRounds; ++round) {
    Vertex vertex;
    int written = 0;
    run_both(
        [&] {
          written = round + 1;
          place(vertex, {1, 1, 1}, VertexKind::kIsosurface);
        },
        [&] {
          wait_until([&] { return peek_point(vertex).*coordinate == 1; });
          EXPECT_EQ(written, round + 1);
        });
  }
}

INSTANTIATE_TEST_SUITE_P(MemoryOrders, EachCoordinate, testing::Values(0, 1, 2),
                         testing::PrintToStringParamName());

// A vertex of the new cell shows its stamp, and what was written before renew().
class EachPeekedVertex : public testing::TestWithParam<std::size_t> {};

TEST_P(EachPeekedVertex, OfANewCellShowsItsStampAndWhatWasWrittenBefore) {
  Mesh mesh(kBox, 1 << 10);
  constexpr CellId kCell = 0;
  for (VertexId round = 0; round < kRounds; ++round) {
    const VertexId first = 100 + 4 * round;
    const std::array<VertexId, 4> vertices{first, first + 1, first + 2, first + 3};
    const VertexId awaited = vertices[GetParam() == 0 ? 3 : 0];  // in the order of peek_two_vertices()
    const std::uint16_t stamp_before = mesh.stamp(kCell);
    VertexId written = 0;
    run_both(
        [&] {
          written = first;
          mesh.renew(kCell, vertices);
        },
        [&] {
          wait_until([&] { return mesh.peek_two_vertices(kCell)[GetParam()] == awaited; });
          EXPECT_NE(mesh.stamp(kCell), stamp_before);
          EXPECT_EQ(written, first);
        });
  }
}

INSTANTIATE_TEST_SUITE_P(MemoryOrders, EachPeekedVertex, testing::Values(0, 1),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace podm::test
