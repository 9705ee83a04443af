// Numbers of commits: each is used once, and increases with every further operation on a vertex.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "delaunay/commit_order.h"
#include "delaunay/tests/triangulator.h"
#include "delaunay/vertex_locks.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

class Commits : public testing::Test {
 protected:
  static constexpr std::size_t kWorkers = 3;

  Commits() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(0.1, 0.9);
    for (int i = 0; i < 200; ++i)
      triangulator_.insert({coordinate(random), coordinate(random), coordinate(random)});
    numbers_of_.resize(mesh().vertex_bound());
    for (CellId c = 0; c < mesh().cell_bound(); ++c)
      if (mesh().cell(c).is_alive()) cells_.push_back(c);
  }

  Mesh& mesh() { return triangulator_.mesh; }
  CellId drawn_cell(std::mt19937& random) const { return cells_[random() % cells_.size()]; }
  // The caller is the only one that uses the vertices of the cell.
  void commit(WorkerId self, CellId c) {
    const std::uint64_t number = order_.next(self, {c}, {});
    for (const VertexId v : mesh().cell(c).vertices) numbers_of_[v].push_back(number);
    numbers_[self].push_back(number);
  }
  // Each vertex's numbers increase.
  bool is_in_order() const {
    return std::all_of(numbers_of_.begin(), numbers_of_.end(), [](const std::vector<std::uint64_t>& numbers) {
      return std::is_sorted(numbers.begin(), numbers.end(), std::less_equal<>());
    });
  }
  std::vector<std::uint64_t> all_numbers() const {
    std::vector<std::uint64_t> all;
    for (const auto& of_worker : numbers_) all.insert(all.end(), of_worker.begin(), of_worker.end());
    std::sort(all.begin(), all.end());
    return all;
  }
  void draw_commits(int count) {
    std::mt19937 random(2);
    for (int i = 0; i < count; ++i) {
      const auto self = static_cast<WorkerId>(random() % kWorkers);
      commit(self, drawn_cell(random));
    }
  }

  ScratchFolder folder_;
  OperationLogWriter log_{folder_ / "run.log"};
  Triangulator triangulator_{Box{{0, 0, 0}, {1, 1, 1}}, 1 << 14};
  CommitOrder order_{triangulator_.mesh, log_, kWorkers};
  std::vector<CellId> cells_;
  std::vector<std::vector<std::uint64_t>> numbers_of_;        // by vertex
  std::array<std::vector<std::uint64_t>, kWorkers> numbers_;  // by worker
};

TEST_F(Commits, AreInOrderAtEveryVertexAndHaveDifferentNumbers) {
  draw_commits(2000);
  EXPECT_TRUE(is_in_order());
  const std::vector<std::uint64_t> all = all_numbers();
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
}

TEST_F(Commits, OfThreadsAreInOrderAtEveryVertex) {
  const auto work = [&](WorkerId self) {
    std::mt19937 random(self);
    VertexLocks locks(self);
    for (int i = 0; i < 2000; ++i) {
      const CellId c = drawn_cell(random);
      const auto& vertices = mesh().cell(c).vertices;
      if (std::all_of(vertices.begin(), vertices.end(),
                      [&](VertexId v) { return locks.try_lock(mesh().vertex(v)) == StepResult::kDone; }))
        commit(self, c);
      locks.unlock_all();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (WorkerId self = 0; self < kWorkers; ++self) threads.emplace_back(work, self);
  }
  EXPECT_TRUE(is_in_order());
}

TEST_F(Commits, FollowEntriesBetweenOperationsAndEarlierSteps) {
  draw_commits(100);
  const std::uint64_t last = all_numbers().back(), first = order_.next_between_operations(10);
  EXPECT_GT(first, last);
  EXPECT_GE(order_.next(0, {cells_.front()}, {}), first + 10);
  log_.begin_step();
  const std::uint64_t next = order_.next(1, {cells_.front()}, {}), of_step = std::uint64_t{1} << kBitsInStep;
  EXPECT_GE(next, of_step);
  EXPECT_LT(next, of_step + kWorkers);
}

TEST_F(Commits, OfOneWorkerAreCounted) {
  CommitOrder alone(mesh(), log_, 1);
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(alone.next(0, {cells_[i]}, {}), i);
}

#ifdef PODM_INTERLEAVING
TEST_F(Commits, AreNotInOrderIfOneVertexOfACellIsLeftOut) {
  plant_fault({.to_order = 3});
  draw_commits(2000);
  plant_fault({});
  EXPECT_FALSE(is_in_order());
}
#endif

}  // namespace
}  // namespace podm::test
