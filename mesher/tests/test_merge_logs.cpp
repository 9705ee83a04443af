// Logs of ranks are merged if they fit together, and refused otherwise.
#include "replay/merge_logs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "podm/errors.h"
#include "tests/fault_of.h"

namespace podm::test {
namespace {

constexpr std::uint32_t kFree = 3;  // a VertexKind

std::uint64_t at(std::uint64_t step, std::uint64_t number) { return (step << kBitsInStep) + number; }

// Logs of three ranks. The first rank makes vertices 8, 9 and 10 at x = 1, 2, 3, which the other ranks learn.
// The ranks change them in two steps with an update between. Rank 0 removes the vertex at x = 1 and inserts
// it again. Rank 1, which does not notice this, removes it then.
class LogsOfRanks : public testing::Test {
 protected:
  LogsOfRanks() {
    for (int rank = 0; rank < 3; ++rank) {
      logs_.push_back({"log." + std::to_string(rank), {}});
      logs_.back().log.head = {{0, 0, 0, 9, 9, 9}, "image", "RAS", "", "cafe", rank, 3};
      for (std::uint32_t i = 0; i < 3; ++i) {
        if (rank == 0) add(rank, at(0, i), 1 + i, 8 + i);
        if (rank > 0) receive_insertion(rank, at(1, i), 1 + i, 8 + i);
      }
    }
    add(0, at(2, 0), 4, 8, {8});
    add(0, at(2, 1), 1, 11);
    add(1, at(2, 0), 5, 11, {10});
    receive_insertion(2, at(3, 0), 5, 11);
    receive_removal(2, at(3, 1), 3, 10);
    add(1, at(4, 0), 6, 12, {8, 11});
  }

  void add(int rank, std::uint64_t sequence, double x, std::uint32_t vertex,
           const std::vector<std::uint32_t>& removed = {}, std::uint32_t kind = kFree) {
    OperationBatch& all = log(rank);
    all.operations.push_back(
        {sequence, {x, 0.5, 0.5}, vertex, 1, kind, static_cast<std::uint32_t>(removed.size())});
    all.removed.insert(all.removed.end(), removed.begin(), removed.end());
  }
  void receive_insertion(int rank, std::uint64_t sequence, double x, std::uint32_t vertex,
                         std::uint32_t kind = kFree) {
    add(rank, sequence, x, vertex, {}, kReceivedInsertion + kind);
  }
  void receive_removal(int rank, std::uint64_t sequence, double x, std::uint32_t vertex) {
    add(rank, sequence, x, vertex, {vertex}, kReceivedRemoval);
  }
  OperationBatch& log(int rank) { return logs_[static_cast<std::size_t>(rank)].log.all; }

  std::string fault() const {
    return fault_of<InputError>([&] { merge_logs(logs_); });
  }

  std::vector<LogOfRank> logs_;
};

TEST_F(LogsOfRanks, NameVerticesByTheirPlaces) {
  std::reverse(logs_.begin(), logs_.end());
  const OperationLog whole = merge_logs(logs_);
  EXPECT_EQ(whole.head.rank, 0);
  std::vector<double> x;
  std::vector<std::uint32_t> workers;
  for (const LoggedOperation& operation : whole.all.operations) {
    EXPECT_EQ(operation.vertex, x.size());
    x.push_back(operation.point[0]);
    workers.push_back(operation.worker);
  }
  EXPECT_EQ(x, (std::vector<double>{1, 2, 3, 4, 1, 5, 6}));
  EXPECT_EQ(whole.all.removed, (std::vector<std::uint32_t>{0, 2, 4, 5}));
  EXPECT_EQ(workers[5], worker_in_whole(1, 1));
  EXPECT_NE(workers[4], workers[5]);
}

// Rank 2 renames vertex 11 to 7, and vertex 9 to 11.
TEST_F(LogsOfRanks, FollowVerticesThatMove) {
  add(2, at(5, 0), 5, 7, {11}, kMovedVertex);
  add(2, at(5, 1), 2, 11, {9}, kMovedVertex);
  add(2, at(5, 2), 7, 9, {11});
  const OperationLog whole = merge_logs(logs_);
  EXPECT_EQ(whole.all.operations.back().point[0], 7);
  EXPECT_EQ(whole.all.removed.back(), 1u);
  for (const LoggedOperation& operation : whole.all.operations) EXPECT_NE(operation.kind, kMovedVertex);
}

TEST_F(LogsOfRanks, AreRefusedWithAVertexThatMovesFromElsewhere) {
  add(2, at(5, 0), 3, 7, {9}, kMovedVertex);
  EXPECT_EQ(fault(), "log.2: operation 0 of step 5: moves a vertex that is at another point");
}

TEST_F(LogsOfRanks, AreOneMachinesAsTheyAre) {
  logs_.resize(1);
  logs_[0].log.head.num_ranks = 1;
  const OperationLog alone = merge_logs(logs_);
  EXPECT_EQ(alone.all.removed, logs_[0].log.all.removed);
  EXPECT_EQ(alone.all.operations.size(), logs_[0].log.all.operations.size());
}

TEST_F(LogsOfRanks, AreAllNeededOnce) {
  const std::vector<LogOfRank> all = logs_;
  logs_ = {all[2], all[0]};
  EXPECT_EQ(fault(), "log.0: the log of rank 1 of 3 is missing");
  logs_ = {all[1], all[0]};
  EXPECT_EQ(fault(), "log.0: the log of rank 2 of 3 is missing");
  logs_ = {all[0], all[1], all[2], all[1]};
  logs_.back().path = "copy";
  EXPECT_EQ(fault(), "copy: a second log of rank 1 of 3; the first is log.1");
  logs_ = all;
  logs_[1].log.head.mesh_hash = "f00d";
  EXPECT_EQ(fault(), "log.1: the log is of another run than log.0");
}

TEST_F(LogsOfRanks, MayLackAMeshThatWasNotFinished) {
  for (const int rank : {1, 2}) log(rank) = {};
  EXPECT_EQ(merge_logs(logs_).all.operations.size(), 5u);
  log(1).operations.push_back(log(0).operations[0]);
  EXPECT_EQ(fault(), "log.1: operation 0: its point is a vertex already");
}

TEST_F(LogsOfRanks, LearnWhatIsSo) {
  const std::vector<LogOfRank> logs = logs_;
  const auto fault_after = [&](const auto& change) {
    logs_ = logs;
    change(log(2).operations);
    return fault();
  };
  using Operations = std::vector<LoggedOperation>&;
  EXPECT_EQ(fault_after([](Operations) {}), "no error");
  EXPECT_EQ(fault_after([](Operations all) { all[3].point[0] = std::nextafter(5, 6); }),
            "log.2: operation 0 of step 3: receives a vertex that no rank has inserted");
  EXPECT_EQ(fault_after([](Operations all) { all[3].kind -= 1; }),
            "log.2: operation 0 of step 3: receives a vertex of another kind than the inserted one");
  EXPECT_EQ(fault_after([](Operations all) { all[3].vertex = 9; }),
            "log.2: operation 0 of step 3: its vertex exists already");
  EXPECT_EQ(fault_after([](Operations all) { all[3].sequence = at(2, 0); }), "no error");  // after rank 1
  EXPECT_EQ(fault_after([](Operations all) { all[3].sequence = at(5, 0), std::swap(all[3], all[4]); }),
            // The vertex no longer exists.
            "log.2: operation 0 of step 5: receives a vertex that no rank has inserted");
  EXPECT_EQ(fault_after([](Operations all) { all[4].point[0] = 2; }),
            "log.2: operation 1 of step 3: a received removal names a vertex at another point");
}

TEST_F(LogsOfRanks, ForgetAndRemoveWhatIsSo) {
  const std::vector<LogOfRank> logs = logs_;
  receive_removal(0, at(5, 0), 2, 9);
  EXPECT_EQ(fault(),
            "log.0: operation 0 of step 5: a received removal names a vertex that no rank has removed");
  logs_ = logs;
  add(2, at(5, 0), 7, 12, {8});
  EXPECT_EQ(fault(), "log.2: operation 0 of step 5: removes a vertex that another rank has removed");
  logs_ = logs;
  add(2, at(5, 0), 7, 12, {10});
  EXPECT_EQ(fault(), "log.2: operation 0 of step 5: removes a vertex that does not exist");
  logs_ = logs;
  add(2, at(5, 0), 2, 12);
  EXPECT_EQ(fault(), "log.2: operation 0 of step 5: its point is a vertex already");
}

}  // namespace
}  // namespace podm::test
