#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <semaphore>
#include <thread>

#include "octree/refinement_queue.h"
#include "random_octrees.h"
#include "refinement_queue_state.h"

namespace podm::test {
namespace {

constexpr LeafOrder kOrders[] = {LeafOrder::kHome, LeafOrder::kMostWork, LeafOrder::kMorton,
                                 LeafOrder::kColoring};

// Returns a row of `num_leaves` leaves.
Octree row_of(double num_leaves) {
  const auto side = [](const Point&, const Point&) { return 1.0; };
  const auto always = [](const Point&, const Point&) { return true; };
  return {{0, 0, 0}, {num_leaves, 1, 1}, 1, side, always};
}

// Blocks threads that wait for leaves.
class Waiting {
 public:
  explicit Waiting(unsigned num_nodes) : woken_(num_nodes) {}
  std::function<void(unsigned)> wake() {
    return [this](unsigned node) { woken_[node].release(); };
  }
  void wait(unsigned node, const std::stop_token& stop) {
    const std::stop_callback on_stop(stop, [&] { woken_[node].release(); });
    woken_[node].acquire();
  }

 private:
  struct Semaphore : std::counting_semaphore<> {
    Semaphore() : std::counting_semaphore<>(0) {}
  };
  std::vector<Semaphore> woken_;
};

class Queue : public testing::TestWithParam<std::tuple<LeafOrder, int>> {
 protected:
  LeafOrder order = std::get<0>(GetParam());
  RandomOctree seeded{static_cast<std::uint64_t>(std::get<1>(GetParam()))};
  Octree octree = seeded.pruned();
  std::vector<GridCube> cubes = cubes_of(seeded.whole());
  bool are_near(LeafId a, LeafId b) const {
    return is_within_two_rings(cubes, octree.cube(a), octree.cube(b));
  }
};

// Makes random calls, as one thread would for several nodes, and checks the invariants after each call.
TEST_P(Queue, HandsOutEveryPendingLeafAwayFromActiveOnes) {
  constexpr unsigned kNumNodes = 5;
  Waiting waiting(kNumNodes);
  RefinementQueue queue(octree, kNumNodes, order, waiting.wake());
  queue.share_out();
  std::set<LeafId> pending;
  std::vector<LeafId> active;
  const auto is_free = [&](LeafId leaf) {
    return std::none_of(active.begin(), active.end(), [&](LeafId other) { return are_near(leaf, other); });
  };
  const auto step = [&](bool is_pushing) {
    const auto choice = seeded.random() % 3;
    if (choice == 0 && is_pushing) {
      const LeafId leaf = static_cast<LeafId>(seeded.random() % octree.num_leaves());
      queue.push(leaf, 1 + seeded.random() % 100);
      pending.insert(leaf);
    } else if (choice == 1 && !active.empty()) {
      std::swap(active.back(), active[seeded.random() % active.size()]);
      queue.finish(active.back());
      active.pop_back();
    } else if (active.size() < kNumNodes) {
      const auto node = static_cast<unsigned>(seeded.random() % kNumNodes);
      const std::optional<LeafId> leaf = pop(queue, node);
      const auto is_for_node = [&](LeafId pending_leaf) {
        return is_free(pending_leaf) && (order != LeafOrder::kHome || queue.home_of(pending_leaf) == node);
      };
      ASSERT_EQ(leaf.has_value(), std::any_of(pending.begin(), pending.end(), is_for_node));
      ASSERT_TRUE(leaf || pending.empty() || !active.empty()) << "all wait, but no leaf is active";
      if (!leaf) return;
      EXPECT_TRUE(is_free(*leaf));
      EXPECT_EQ(pending.erase(*leaf), 1u);
      active.push_back(*leaf);
    }
    const RefinementQueueState::Counts counts = RefinementQueueState(queue).counts();
    EXPECT_EQ(counts.pending, pending.size());
    EXPECT_EQ(counts.active, active.size());
    EXPECT_EQ(counts.ready, std::size_t(std::count_if(pending.begin(), pending.end(), is_free)));
  };
  if (octree.num_leaves() == 0) return;
  for (int i = 0; i < 300 && !HasFatalFailure(); ++i) step(true);
  while (!HasFatalFailure() && !(pending.empty() && active.empty())) step(false);
}

TEST_P(Queue, RepeatsItselfForTheSameCalls) {
  const auto run = [&] {
    std::mt19937_64 random(3);
    RefinementQueue queue(octree, 4, order);
    queue.share_out();
    for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf) queue.push(leaf, 1 + random() % 100);
    std::vector<std::optional<LeafId>> answers;
    std::vector<LeafId> active;
    for (unsigned i = 0; i < 200; ++i) {
      answers.push_back(pop(queue, i % 4));
      if (answers.back()) active.push_back(*answers.back());
      if (active.empty() || random() % 2 == 0) continue;
      queue.finish(active.front());
      active.erase(active.begin());
    }
    return answers;
  };
  EXPECT_EQ(run(), run());
}

// Each node writes data without locks while its leaf is active. Sanitizers detect two nodes that write at
// once.
TEST_P(Queue, ThreadsRefineEveryLeafWithItsRegionToThemselves) {
  constexpr unsigned kNumNodes = 4;
  Waiting waiting(kNumNodes);
  RefinementQueue queue(octree, kNumNodes, order, waiting.wake());
  queue.share_out();
  std::vector<unsigned> user_of(cubes.size());         // per cube: node + 1, or 0
  std::vector<unsigned> poor_of(octree.num_leaves());  // poor cells, given by the leaf itself or by its ring
  std::atomic<unsigned> num_pushed = octree.num_leaves(), num_refined = 0, num_shared = 0;
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf) {
    poor_of[leaf] = 1;
    queue.push(leaf, 1);
  }
  const auto refine = [&](unsigned node, LeafId leaf, std::mt19937_64& random) {
    for (std::size_t i = 0; i < cubes.size(); ++i)
      if (touch(cubes[i], octree.cube(leaf)) && std::exchange(user_of[i], node + 1) != 0) ++num_shared;
    num_refined += std::exchange(poor_of[leaf], 0);
    std::this_thread::yield();
    std::vector<LeafId> to = octree.first_ring(leaf);
    to.push_back(leaf);
    for (const LeafId other : to) {
      if (random() % (2 * to.size()) != 0) continue;
      ++num_pushed;
      ++poor_of[other];
      queue.push(other, 1);
    }
    for (std::size_t i = 0; i < cubes.size(); ++i)
      if (touch(cubes[i], octree.cube(leaf)) && std::exchange(user_of[i], 0) != node + 1) ++num_shared;
  };
  {
    std::vector<std::jthread> nodes;
    for (unsigned node = 0; node < kNumNodes; ++node) {
      nodes.emplace_back([&, node](std::stop_token stop) {
        std::mt19937_64 random(node);
        const auto wait = [&] { waiting.wait(node, stop); };
        while (const std::optional<LeafId> leaf = queue.wait_and_pop(node, wait, stop)) {
          refine(node, *leaf, random);
          queue.finish(*leaf);
        }
      });
    }
    for (std::jthread& node : nodes) node.join();  // the destructor would request a stop
  }
  EXPECT_EQ(num_shared, 0u);
  EXPECT_EQ(num_refined, num_pushed);
  const RefinementQueueState::Counts counts = RefinementQueueState(queue).counts();
  EXPECT_EQ(counts.pending + counts.active + counts.waiting, 0u);
}

INSTANTIATE_TEST_SUITE_P(Orders, Queue, testing::Combine(testing::ValuesIn(kOrders), testing::Range(0, 12)));

class Shares : public testing::TestWithParam<std::uint64_t> {};

// The tolerance has this reason: a leaf may be on either side of a cut, and the shares of three nodes have
// two cuts between them.
TEST_P(Shares, HaveEqualWorkAndGoToTheirNodes) {
  constexpr unsigned kNumNodes = 3, kMost = 100;
  RandomOctree seeded{GetParam()};
  const Octree octree = seeded.pruned();
  if (octree.num_leaves() < kNumNodes) return;
  RefinementQueue queue(octree, kNumNodes);
  std::vector<double> work_of_leaf(octree.num_leaves()), work_of_node(kNumNodes);
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf) {
    work_of_leaf[leaf] = 1 + static_cast<double>(seeded.random() % kMost);
    queue.push(leaf, static_cast<std::uint64_t>(work_of_leaf[leaf]));
  }
  queue.share_out();
  for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf)
    work_of_node[queue.home_of(leaf)] += work_of_leaf[leaf] + 1;
  const double mean = std::reduce(work_of_node.begin(), work_of_node.end()) / kNumNodes;
  for (unsigned node = 0; node < kNumNodes; ++node) {
    EXPECT_NEAR(work_of_node[node], mean, 2 * (kMost + 1));
    if (work_of_node[node] == 0) continue;
    const std::optional<LeafId> leaf = pop(queue, node);
    ASSERT_TRUE(leaf);
    EXPECT_EQ(queue.home_of(*leaf), node);
    queue.finish(*leaf);
  }
}

// Node 1 has finished its share when node 0 has just begun: node 1 takes over half of the rest.
TEST(Share, OfWhoHasMostIsHalvedForWhoHasNone) {
  const Octree octree = row_of(32);
  RefinementQueue queue(octree, 2);
  queue.share_out();
  for (LeafId leaf = 0; leaf < 16; ++leaf) queue.push(leaf, 10);
  ASSERT_EQ(queue.home_of(15), 0u);
  const std::optional<LeafId> taken = pop(queue, 1);
  ASSERT_TRUE(taken);
  unsigned num_taken_over = 0;
  for (LeafId leaf = 0; leaf < 16; ++leaf) num_taken_over += queue.home_of(leaf) == 1;
  EXPECT_EQ(num_taken_over, 8u);
  EXPECT_EQ(queue.home_of(*taken), 1u);
}

// In a row of two shares, the leaves beside the cut are rivals of the other share's leaves.
TEST(Share, IsRefinedFromItsContendedLeavesInwards) {
  const Octree octree = row_of(32);
  RefinementQueue queue(octree, 2);
  for (LeafId leaf = 0; leaf < 32; ++leaf) queue.push(leaf, 16 + (leaf % 16) % 5);
  queue.share_out();
  EXPECT_EQ(pop(queue, 0), LeafId{15}) << "leaves of the same number of digits";
  EXPECT_GT(pop(queue, 1), LeafId{17});
  queue.push(3, 100);
  queue.finish(15);
  queue.push(15, 2);
  EXPECT_EQ(pop(queue, 0), LeafId{3}) << "most poor cells first";
}

// Node 0's leaves are near an active leaf; node 1 has leaves to spare.
TEST(Share, IsNotLeftWhileItHasPoorCells) {
  const Octree octree = row_of(32);
  RefinementQueue queue(octree, 2);
  queue.share_out();
  queue.push(16, 1);
  ASSERT_EQ(pop(queue, 1), LeafId{16});
  queue.push(15, 1);
  for (LeafId leaf = 20; leaf < 32; ++leaf) queue.push(leaf, 100);
  EXPECT_EQ(pop(queue, 0), std::nullopt);
  queue.finish(16);
  EXPECT_EQ(pop(queue, 0), LeafId{15});
  EXPECT_GT(pop(queue, 0), LeafId{16}) << "it is through with it";
}

TEST(Share, OfTheFirstNodeIsAllUntilItIsSharedOutWithoutAStopRequest) {
  const Octree octree = row_of(32);
  RefinementQueue queue(octree, 4);
  const auto shares = [&] {
    std::vector<int> leaves(4);
    for (LeafId leaf = 0; leaf < octree.num_leaves(); ++leaf) ++leaves[queue.home_of(leaf)];
    return leaves;
  };
  EXPECT_EQ(shares(), (std::vector{32, 0, 0, 0}));
  std::stop_source stop;
  stop.request_stop();
  queue.share_out(stop.get_token());
  EXPECT_EQ(shares(), (std::vector{32, 0, 0, 0}));
  queue.share_out();
  EXPECT_EQ(shares(), (std::vector{8, 8, 8, 8}));
}

INSTANTIATE_TEST_SUITE_P(Seeds, Shares, testing::Range(std::uint64_t{0}, std::uint64_t{12}));

class SmallQueue : public testing::Test {
 protected:
  SmallQueue() { queue.share_out(); }
  std::optional<LeafId> wait_and_pop(unsigned node, const std::stop_token& stop = {}) {
    return queue.wait_and_pop(
        node, [&] { waiting.wait(node, stop); }, stop);
  }

  Octree octree = row_of(8);
  Waiting waiting{2};
  RefinementQueue queue{octree, 2, LeafOrder::kHome, waiting.wake()};
};

TEST_F(SmallQueue, IsFinishedWhenNothingIsPendingNorActive) {
  EXPECT_EQ(wait_and_pop(0), std::nullopt);
  queue.push(3, 0);
  EXPECT_EQ(wait_and_pop(0), std::nullopt);
}

TEST_F(SmallQueue, LeavesNearAnActiveOneWaitForItsEnd) {
  queue.push(3, 5);
  ASSERT_EQ(wait_and_pop(0), LeafId{3});
  queue.push(3, 1);
  queue.push(5, 1);
  EXPECT_EQ(pop(queue, 1), std::nullopt);
  queue.push(6, 1);
  EXPECT_EQ(pop(queue, 1), LeafId{6});
  queue.finish(3);
  EXPECT_EQ(pop(queue, 0), LeafId{3});
}

TEST_F(SmallQueue, WaitersGoOnWhenALeafIsFinishedAndEndTogether) {
  queue.push(3, 1);
  ASSERT_EQ(pop(queue, 0), LeafId{3});
  queue.push(4, 1);
  std::atomic<unsigned> num_taken = 0;
  std::vector<std::jthread> waiters;
  for (unsigned node = 0; node < 2; ++node) {
    waiters.emplace_back([&, node] {
      while (const auto leaf = wait_and_pop(node)) {
        ++num_taken;
        queue.finish(*leaf);
      }
    });
  }
  while (RefinementQueueState(queue).counts().waiting < 2) std::this_thread::yield();
  EXPECT_EQ(num_taken, 0u);
  queue.finish(3);
  for (std::jthread& waiter : waiters) waiter.join();
  EXPECT_EQ(num_taken, 1u);
}

TEST_F(SmallQueue, StopWakesWaitersAndHandsOutNothingMore) {
  queue.push(3, 1);
  ASSERT_EQ(pop(queue, 0), LeafId{3});
  queue.push(4, 1);
  std::optional<LeafId> answer = 0;
  std::jthread waiter([&](std::stop_token stop) { answer = wait_and_pop(1, stop); });
  while (RefinementQueueState(queue).counts().waiting == 0) std::this_thread::yield();
  waiter.request_stop();
  waiter.join();
  EXPECT_EQ(answer, std::nullopt);
  queue.finish(3);
  EXPECT_EQ(wait_and_pop(1, waiter.get_stop_token()), std::nullopt);
  EXPECT_EQ(RefinementQueueState(queue).counts().pending, 1u);
}

}  // namespace
}  // namespace podm::test
