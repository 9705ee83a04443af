// Workers under every kind of coordination use up cells that are mere numbers. Every cell is used once, and
// the master learns when no cell is left, for any order of conflicts, waits, gifts and cells sent home.
#include <gtest/gtest.h>

#include <atomic>
#include <random>

#include "two_sockets.h"
#include "workers/coordination.h"
#include "workers/real_time.h"
#include "workers/virtual_time.h"

namespace podm::test {
namespace {

constexpr int kNumWorkers = 12, kNumHomes = 4;

// A worker that meets other workers at random. Using its cells makes more cells while any are left to be
// made.
class Player {
 public:
  Player(WorkerId self, std::atomic<int>& num_left_to_make, std::atomic<int>& num_used)
      : self_(self), num_left_to_make_(num_left_to_make), num_used_(num_used), random_(self) {}

  WorkerId id() const { return self_; }
  bool has_work() const { return !cells_.empty(); }
  std::size_t num_listed() const { return cells_.size(); }
  void give(const Coordination::Entries& cells) { cells_.insert(cells_.end(), cells.begin(), cells.end()); }
  Coordination::Entries share(std::size_t most) {
    Coordination::Entries given;
    while (given.size() < most && given.size() < cells_.size()) {
      given.push_back(cells_.back());
      cells_.pop_back();
    }
    return given;
  }
  Outcome attempt() {
    if (random_() % 4 == 0) {
      holder_ = static_cast<WorkerId>((self_ + 1 + random_() % (kNumWorkers - 1)) % kNumWorkers);
      return Outcome::kLockConflict;
    }
    cells_.pop_back();
    ++num_used_;
    for (int made = 0; made < 3 && num_left_to_make_.fetch_sub(1) > 0; ++made)
      (random_() % 3 == 0 ? away_ : cells_).push_back({});
    return Outcome::kCommitted;
  }
  void release() {}
  // Cells that are to be refined at another home.
  Coordination::Entries take_away() { return std::exchange(away_, {}); }
  unsigned any_home() { return random_() % kNumHomes; }
  WorkerId conflicting_worker() const { return holder_; }
  // All counts stay 0: virtual time charges all attempts alike.
  const Counters& counters() const { return counters_; }
  const std::optional<AccessTally>& accesses() const { return accesses_; }
  std::int64_t net_cells() const { return 0; }

 private:
  WorkerId self_, holder_ = 0;
  std::atomic<int>&num_left_to_make_, &num_used_;
  std::mt19937 random_;
  Coordination::Entries cells_, away_;
  std::optional<AccessTally> accesses_;
  Counters counters_;
};

class Coordinated : public testing::TestWithParam<std::tuple<Contention, bool, bool>> {
 protected:
  // The players do what PODM's loop does, in one round of the master after the other, like leaf after leaf.
  template <class Time>
  void play(Time& time) {
    constexpr int kRounds = 15, kCells = 3000;
    const auto [contention, is_nested, has_homes] = GetParam();
    std::atomic<int> num_left_to_make = 0, num_used = 0;
    std::vector<Player> players;
    for (WorkerId self = 0; self < kNumWorkers; ++self)
      players.emplace_back(self, num_left_to_make, num_used);
    Coordination group({.num_workers = kNumWorkers,
                        .contention = contention,
                        .groups = is_nested ? kNested : WorkerGroups{},
                        .workers_per_home = has_homes ? kNumWorkers / kNumHomes : 0,
                        .seed = 5},
                       [&](WorkerId worker) { time.resume(worker); });
    time.run([&](WorkerId self) {
      if (self != 0) {
        work(players[self], group, time);
        return;
      }
      for (int round = 1; round <= kRounds; ++round) {
        num_left_to_make = kCells - 1;
        players[0].give({{}});
        work(players[0], group, time);
        EXPECT_EQ(num_used, round * kCells);
      }
      group.dismiss();
    });
    EXPECT_FALSE(stop_.is_over());
  }

  StopControl stop_{{}, {}, [](std::uint64_t) {}};

 private:
  template <class Time>
  void work(Player& player, Coordination& group, Time& time) {
    const WorkerId self = player.id();
    for (;;) {
      if (player.has_work()) {
        const Outcome outcome = time.attempt(player);
        const auto [answer, pause_s] = group.after(outcome, self, player);
        if (const Coordination::Entries away = player.take_away(); !std::get<2>(GetParam())) {
          player.give(away);
        } else if (!away.empty()) {
          group.send(player.any_home(), away);
        }
        if (answer == ContentionManager::Answer::kWait) time.block(self, &Overhead::contention_s);
        if (answer == ContentionManager::Answer::kPause) time.pause(self, pause_s);
      } else {
        const Coordination::Begging begging = group.beg(self);
        if (begging == Coordination::Begging::kOver) return;
        if (begging == Coordination::Begging::kListed) time.block(self, &Overhead::begging_s);
        player.give(group.take_gift(self));
      }
    }
  }
};

TEST_P(Coordinated, UsesUpAllCellsOnThreads) {
  RealTime time(stop_, kNumWorkers, {});
  play(time);
}

TEST_P(Coordinated, UsesUpAllCellsInVirtualTime) {
  VirtualTime time(stop_, kNumWorkers, VirtualCost::kUnit, 3);
  play(time);
}

INSTANTIATE_TEST_SUITE_P(Managers, Coordinated,
                         testing::Combine(testing::Values(Contention::kAggressive, Contention::kRandom,
                                                          Contention::kGlobal, Contention::kLocal),
                                          testing::Bool(), testing::Bool()),
                         [](const auto& of) {
                           return to_string(std::get<0>(of.param)) + (std::get<1>(of.param) ? "Nested" : "") +
                                  (std::get<2>(of.param) ? "AtHome" : "");
                         });

// Finds nothing to share, so that a beggar is taken off its list and put back while another worker sends
// cells home.
struct Dry {
  Coordination& group;
  std::size_t num_listed() const { return 64; }
  Coordination::Entries share(std::size_t) {
    group.send(2, {{}});
    return {};
  }
  WorkerId conflicting_worker() const { return 0; }
};

TEST(Homes, CellsThatComeWhileABeggarIsOffItsListAreServed) {
  std::vector<WorkerId> resumed;
  Coordination group({.num_workers = 3, .workers_per_home = 1}, [&](WorkerId w) { resumed.push_back(w); });
  ASSERT_EQ(group.beg(2), Coordination::Begging::kListed);
  Dry giver{group};
  group.after(Outcome::kSound, 0, giver);
  EXPECT_EQ(resumed, std::vector<WorkerId>{2});
  EXPECT_EQ(group.take_gift(2).size(), 1u);
}

TEST(Homes, ACellWakesOneBeggar) {
  std::vector<WorkerId> resumed;
  Coordination group({.num_workers = 4, .workers_per_home = 2}, [&](WorkerId w) { resumed.push_back(w); });
  for (const WorkerId worker : {2u, 3u}) ASSERT_EQ(group.beg(worker), Coordination::Begging::kListed);
  group.send(1, {{}});
  EXPECT_EQ(resumed, std::vector<WorkerId>{2});
}

}  // namespace
}  // namespace podm::test
