// The cost of remote access: latency per link, waiting at busy stations, lines that caches keep.
#include "workers/remote_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "runtime/read_lines.h"

namespace podm::test {
namespace {

constexpr double kHop = 1e-6, kService = 1e-7;

// Three nodes in a row, 0 - 1 - 2, each with its hub. The hub of the middle node may be slow.
MachineModel row_of_three(double miss_share, double service_s, double retries = 0) {
  MachineModel machine{.name = "row", .topology = Topology::synthetic("numa:3 core:4 pu:1")};
  machine.hop_latency_s = kHop;
  machine.miss_share = miss_share;
  machine.retries = retries;
  machine.stations = {{"node 0", 0}, {"node 1", service_s}, {"node 2", 0}};
  machine.routes = {{}, {0, 1}, {0, 1, 2}, {1, 0}, {}, {1, 2}, {2, 1, 0}, {2, 1}, {}};
  return machine;
}

AccessTally tally_of(NodeIndex owner, int num_reads, AccessKind kind = AccessKind::kMeshRead) {
  AccessTally tally(3);
  for (int i = 0; i < num_reads; ++i) tally.add(kind, owner, &tally);
  return tally;
}

TEST(RemoteMemory, CostsTheLinksThatCachesDoNotSave) {
  const MachineModel machine = row_of_three(0.5, 0);
  RemoteMemory memory(machine, {0, 0, 0});
  EXPECT_DOUBLE_EQ(memory.delay(0, tally_of(0, 10), 0).latency_s, 0) << "its own node's";
  EXPECT_DOUBLE_EQ(memory.delay(1, tally_of(1, 10), 0).latency_s, 0.5 * 10 * kHop);
  EXPECT_DOUBLE_EQ(memory.delay(2, tally_of(2, 10), 0).latency_s, 0.5 * 10 * 2 * kHop);
}

TEST(RemoteMemory, ChargesEachAccessOnce) {
  const MachineModel machine = row_of_three(1, 0);
  RemoteMemory memory(machine, {0});
  AccessTally tally = tally_of(1, 3);
  EXPECT_DOUBLE_EQ(memory.delay(0, tally, 0).latency_s, 3 * kHop);
  EXPECT_DOUBLE_EQ(memory.delay(0, tally, 1).latency_s, 0);
  tally.add(AccessKind::kMeshWrite, 1, &tally);
  EXPECT_DOUBLE_EQ(memory.delay(0, tally, 2).latency_s, kHop);
}

TEST(RemoteMemory, DataThatNoWorkerWritesIsFetchedWholly) {
  const MachineModel machine = row_of_three(0.1, 0);
  RemoteMemory memory(machine, {0, 0});
  EXPECT_DOUBLE_EQ(memory.delay(0, tally_of(1, 8, AccessKind::kFirstRead), 0).latency_s, 8 * kHop);
  EXPECT_DOUBLE_EQ(memory.delay(1, tally_of(1, 8, AccessKind::kImageRead), 0).latency_s, 0)
      << "caches keep it";
}

// The second worker finds accesses of the first at the station. The third, later, finds none.
TEST(RemoteMemory, StationsServeOneAccessAfterTheOther) {
  const MachineModel machine = row_of_three(1, kService);
  RemoteMemory memory(machine, {0, 0, 2});
  EXPECT_DOUBLE_EQ(memory.delay(0, tally_of(1, 20), 0).network_s, 0);
  EXPECT_DOUBLE_EQ(memory.delay(1, tally_of(2, 5), 0.5e-6).network_s, 5 * (20 * kService - 0.5e-6));
  EXPECT_DOUBLE_EQ(memory.delay(2, tally_of(1, 20), 1).network_s, 0);
}

// Workers that each wait for their accesses get no more from a station than its capacity. With retries they
// get less, and the less, the more of them wait.
double accesses_per_second(double retries, WorkerId num_workers) {
  const MachineModel machine = row_of_three(1, kService, retries);
  RemoteMemory memory(machine, std::vector<NodeIndex>(num_workers, 0));
  std::vector<double> ready_at(num_workers, 0.0);
  std::vector<AccessTally> tallies(num_workers, AccessTally(3));
  constexpr int kAttempts = 20000, kAccesses = 1;
  for (int i = 0; i < kAttempts; ++i) {
    const auto first = std::min_element(ready_at.begin(), ready_at.end());
    const auto worker = static_cast<WorkerId>(first - ready_at.begin());
    for (int k = 0; k < kAccesses; ++k) tallies[worker].add(AccessKind::kMeshRead, 1, &tallies);
    *first += kHop + memory.delay(worker, tallies[worker], *first).network_s;
  }
  return kAttempts * kAccesses / *std::max_element(ready_at.begin(), ready_at.end());
}

TEST(RemoteMemory, BusyStationsBoundTheRate) {
  EXPECT_NEAR(accesses_per_second(0, 16) * kService, 1, 0.05);
  EXPECT_NEAR(accesses_per_second(0, 64) * kService, 1, 0.05);
  const double few = accesses_per_second(0.1, 16), many = accesses_per_second(0.1, 64);
  EXPECT_LT(few * kService, 0.9);
  EXPECT_LT(many, 0.5 * few);
}

TEST(ReadLines, AreFirstOnceForEachNode) {
  ReadLines lines(1000, 2);
  EXPECT_TRUE(lines.is_first(0, 64));
  EXPECT_FALSE(lines.is_first(0, 127)) << "the same line";
  EXPECT_TRUE(lines.is_first(0, 128));
  EXPECT_TRUE(lines.is_first(1, 64)) << "another node";
  EXPECT_TRUE(lines.is_first(1, 999));
}

}  // namespace
}  // namespace podm::test
