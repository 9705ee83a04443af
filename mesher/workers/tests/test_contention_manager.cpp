#include <gtest/gtest.h>

#include <algorithm>

#include "workers/contention_manager.h"

namespace podm::test {
namespace {

enum class State { kRunning, kWaiting, kBegging };

// Random conflicts, random successes, and workers that run out of work, one event after the other.
class Crowd {
 public:
  Crowd(Contention contention, int num_workers, std::uint64_t seed)
      : states_(static_cast<std::size_t>(num_workers), State::kRunning),
        contention_(contention, num_workers, seed),
        random_(seed) {}

  void step() {
    const std::vector<WorkerId> running = all(State::kRunning);
    const WorkerId self = running[random_() % running.size()];
    switch (random_() % 8) {
      case 0: {
        states_[self] = State::kBegging;
        for (const WorkerId worker : contention_.begin_to_beg(self)) wake(worker);
        break;
      }
      case 1:
      case 2: {
        const bool may_wake = contention_.may_wake(self);
        const WorkerId worker = contention_.wake(self);
        EXPECT_EQ(may_wake, worker != kNoWorker);
        if (worker != kNoWorker) wake(worker);
        const std::vector<WorkerId> begging = all(State::kBegging);
        if (begging.empty()) break;
        contention_.run_again(begging.front());
        states_[begging.front()] = State::kRunning;
        break;
      }
      default: {
        const auto holder = static_cast<WorkerId>(random_() % states_.size());
        if (holder == self) return;
        if (contention_.conflict(self, holder, 1).kind == ContentionManager::Answer::kWait)
          states_[self] = State::kWaiting;
      }
    }
  }
  std::vector<WorkerId> all(State state) const {
    std::vector<WorkerId> found;
    for (WorkerId worker = 0; worker < states_.size(); ++worker)
      if (states_[worker] == state) found.push_back(worker);
    return found;
  }

 private:
  void wake(WorkerId worker) {
    EXPECT_EQ(states_[worker], State::kWaiting);
    states_[worker] = State::kRunning;
  }

  std::vector<State> states_;
  ContentionManager contention_;
  std::mt19937_64 random_;
};

class Waiting : public testing::TestWithParam<Contention> {};

TEST_P(Waiting, NeverHoldsAllWorkers) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Crowd crowd(GetParam(), 1 + static_cast<int>(seed % 9), seed);
    for (int step = 0; step < 500 && !crowd.all(State::kRunning).empty(); ++step) crowd.step();
    EXPECT_TRUE(!crowd.all(State::kRunning).empty() || crowd.all(State::kWaiting).empty()) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Managers, Waiting, testing::Values(Contention::kGlobal, Contention::kLocal),
                         [](const auto& manager) { return to_string(manager.param); });

TEST(LocalContention, WaitsForTheHolderAndIsWokenByIt) {
  ContentionManager contention(Contention::kLocal, 3, 1);
  ASSERT_EQ(contention.conflict(0, 1, 1).kind, ContentionManager::Answer::kWait);
  EXPECT_FALSE(contention.may_wake(2)) << "it waits for another";
  EXPECT_EQ(contention.wake(2), kNoWorker);
  EXPECT_EQ(contention.conflict(1, 0, 1).kind, ContentionManager::Answer::kTryOn) << "0 waits itself";
  EXPECT_TRUE(contention.may_wake(1));
  EXPECT_EQ(contention.wake(1), 0u);
  EXPECT_FALSE(contention.may_wake(1));
  EXPECT_EQ(contention.conflict(1, 0, 1).kind, ContentionManager::Answer::kWait) << "0 runs again";
}

TEST(RandomContention, PausesAfterConflictsInARow) {
  ContentionManager contention(Contention::kRandom, 2, 1);
  EXPECT_EQ(contention.conflict(0, 1, 1).kind, ContentionManager::Answer::kTryOn);
  const auto answer = contention.conflict(0, 1, ContentionManager::kConflictsToPause);
  ASSERT_EQ(answer.kind, ContentionManager::Answer::kPause);
  EXPECT_GE(answer.pause_s, 0.001);
  EXPECT_LE(answer.pause_s, 0.005);
}

}  // namespace
}  // namespace podm::test
