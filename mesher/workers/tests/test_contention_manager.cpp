#include <gtest/gtest.h>

#include <algorithm>

#include "workers/contention_manager.h"

namespace podm::test {
namespace {

using State = Activity::State;

// Random conflicts, successes and workers that run out of work, as an executor would pass them on.
class Crowd {
 public:
  Crowd(Contention contention, int num_workers, std::uint64_t seed)
      : activity(num_workers), contention_(contention, num_workers, seed), random_(seed) {}

  void step() {
    const std::vector<WorkerId> running = all(State::kRunning);
    const WorkerId self = running[random_() % running.size()];
    switch (random_() % 8) {
      case 0: {
        for (const WorkerId worker : contention_.idle(self, activity)) activity.set(worker, State::kRunning);
        activity.set(self, State::kBegging);
        break;
      }
      case 1:
      case 2: {
        const WorkerId worker = contention_.wake(self);
        if (worker != kNoWorker) activity.set(worker, State::kRunning);
        const std::vector<WorkerId> begging = all(State::kBegging);
        if (!begging.empty()) activity.set(begging.front(), State::kRunning);
        break;
      }
      default: {
        const auto holder = static_cast<WorkerId>(random_() % num_workers());
        if (holder == self) return;
        const auto answer = contention_.conflict(self, holder, 1, activity);
        if (answer.kind == ContentionManager::Answer::kWait) activity.set(self, State::kWaiting);
      }
    }
  }
  std::vector<WorkerId> all(State state) const {
    std::vector<WorkerId> found;
    for (WorkerId worker = 0; worker < num_workers(); ++worker)
      if (activity.of(worker) == state) found.push_back(worker);
    return found;
  }

  Activity activity;

 private:
  WorkerId num_workers() const { return num_workers_; }
  WorkerId num_workers_ = static_cast<WorkerId>(activity.num_running());
  ContentionManager contention_;
  std::mt19937_64 random_;
};

class Waiting : public testing::TestWithParam<Contention> {};

TEST_P(Waiting, NeverHoldsAllWorkers) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const int num_workers = 1 + static_cast<int>(seed % 9);
    Crowd crowd(GetParam(), num_workers, seed);
    for (int step = 0; step < 500 && crowd.activity.num_running() > 0; ++step) crowd.step();
    EXPECT_TRUE(crowd.activity.num_running() > 0 || crowd.all(State::kWaiting).empty()) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Managers, Waiting, testing::Values(Contention::kGlobal, Contention::kLocal),
                         [](const auto& manager) { return to_string(manager.param); });

TEST(LocalContention, WaitsForTheHolderAndIsWokenByIt) {
  Activity activity(3);
  ContentionManager contention(Contention::kLocal, 3, 1);
  ASSERT_EQ(contention.conflict(0, 1, 1, activity).kind, ContentionManager::Answer::kWait);
  activity.set(0, State::kWaiting);
  EXPECT_EQ(contention.wake(2), kNoWorker);
  EXPECT_EQ(contention.conflict(1, 0, 1, activity).kind, ContentionManager::Answer::kTryOn)
      << "0 waits itself";
  EXPECT_EQ(contention.wake(1), 0u);
  EXPECT_FALSE(contention.has_waiting());
}

TEST(RandomContention, PausesAfterConflictsInARow) {
  const Activity activity(2);
  ContentionManager contention(Contention::kRandom, 2, 1);
  EXPECT_EQ(contention.conflict(0, 1, 1, activity).kind, ContentionManager::Answer::kTryOn);
  const auto answer = contention.conflict(0, 1, ContentionManager::kConflictsToPause, activity);
  ASSERT_EQ(answer.kind, ContentionManager::Answer::kPause);
  EXPECT_GE(answer.pause_s, 0.001);
  EXPECT_LE(answer.pause_s, 0.005);
}

}  // namespace
}  // namespace podm::test
