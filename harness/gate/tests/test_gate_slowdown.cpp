// Tests of the rule about seconds, on given rounds and on the simulated machine.
#include "gate/gate_slowdown.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "gate/drawn_order.h"
#include "gate/gate_evidence.h"
#include "gate/simulated_machine.h"
#include "rows/order_statistics.h"

namespace podm::bench {
namespace {

constexpr int kTries = 200;

Slowdown slowdown_on(SimulatedMachine machine, double head_over_base) {
  return measure_slowdown([&] { return machine.round(head_over_base); }).value();
}

// Rounds whose heads alternate between the two ratios, as noise without chance.
Slowdown slowdown_of(double ratio, double other_ratio) {
  int num_rounds = 0;
  return measure_slowdown([&] {
           return Round{2, 2 * (++num_rounds % 2 == 0 ? ratio : other_ratio)};
         })
      .value();
}

TEST(Slowdown, OfFivePercentOrMoreBlocksInNineOfTenTriesAndOfNothingInOneOfTwentyAtMost) {
  for (const GateTries& row : simulated_tries(kTries)) {
    ASSERT_EQ(row.slower + row.not_slower + row.not_resolved, kTries);
    if (row.planted_percent >= 5) {
      EXPECT_GE(row.slower, kTries * 9 / 10) << table_of({row});
    } else if (row.planted_percent == 0) {
      EXPECT_LE(row.slower, kTries / 20) << table_of({row});
      EXPECT_GE(row.not_slower, kTries * 9 / 10) << table_of({row});
    }
  }
}

TEST(Slowdown, IsNotTakenFromAGain) {
  for (int seed = 0; seed < kTries; ++seed)
    EXPECT_EQ(slowdown_on(SimulatedMachine(static_cast<std::uint64_t>(seed), 0.03), 0.8).answer,
              Answer::kNotSlower);
}

TEST(Slowdown, LostInNoiseIsNotResolvedAndPredictsTheRoundsThatAnAnswerTakes) {
  int num_answered = 0;
  for (std::uint64_t seed = 0; seed < kTries; ++seed) {
    const Slowdown slowdown = slowdown_on(SimulatedMachine(seed, 0.4), 1.025);
    num_answered += slowdown.answer != Answer::kNotResolved;
    if (slowdown.answer != Answer::kNotResolved) continue;
    EXPECT_EQ(slowdown.num_rounds, kLooks.back());
    EXPECT_GT(slowdown.rounds_for_an_answer(), 10 * kLooks.back());
    EXPECT_LT(slowdown.rounds_for_an_answer(), 1000 * kLooks.back());
  }
  EXPECT_LE(num_answered, kTries / 10);  // 5 % of the intervals may miss, and 1.025 is near both bounds
}

TEST(Slowdown, IntervalsHoldTheTrueRatioAtAllLooksTogether) {
  int num_held = 0;
  for (int seed = 0; seed < kTries; ++seed) {
    SimulatedMachine machine(static_cast<std::uint64_t>(seed), 0.03);
    std::vector<Round> rounds;
    bool holds = true;
    for (const int look : kLooks) {
      while (static_cast<int>(rounds.size()) < look) rounds.push_back(machine.round(1.07));
      const CentreEstimate ratio = head_over_base(rounds);
      holds = holds && ratio.low <= 1.07 && 1.07 <= ratio.high;
    }
    num_held += holds;
  }
  EXPECT_GE(num_held, kConfidenceOfLooks * kTries);
}

TEST(Slowdown, ThatIsClearTakesTheFirstLookAloneAndItsRatioIsTheRounds) {
  const Slowdown slower = slowdown_of(1.2, 1.2), same = slowdown_of(1, 1);
  EXPECT_EQ(slower.answer, Answer::kSlower);
  EXPECT_EQ(slower.num_rounds, kLooks.front());
  EXPECT_NEAR(slower.ratio.value, 1.2, 1e-12);
  EXPECT_EQ(same.answer, Answer::kNotSlower);
  EXPECT_EQ(same.num_rounds, kLooks.front());
}

TEST(Slowdown, IsAnsweredWhereTheIntervalIsNarrowerThanThreePercent) {
  for (double ratio = 0.95; ratio < 1.1; ratio += 0.001) {
    const Slowdown slowdown = slowdown_of(ratio * 0.995, ratio * 1.005);
    ASSERT_LT(slowdown.ratio.high - slowdown.ratio.low, 0.03);
    EXPECT_NE(slowdown.answer, Answer::kNotResolved) << ratio;
    EXPECT_EQ(slowdown.answer == Answer::kSlower, slowdown.ratio.low > kNoticeable) << ratio;
  }
}

TEST(Slowdown, OfRoundsThatEndHasNoAnswer) {
  int num_left = kLooks.front() - 1;
  EXPECT_FALSE(measure_slowdown([&]() -> std::optional<Round> {
    if (num_left-- == 0) return {};
    return Round{1, 2};
  }));
}

TEST(DrawnOrder, PutsEachProcessAsOftenBeforeAnotherAsAfterIt) {
  DrawnOrder order(4, 7);
  std::map<std::pair<std::size_t, std::size_t>, int> num_before;
  for (int round = 0; round < 40; ++round) {
    const std::vector<std::size_t> processes = order.next();
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) ++num_before[{processes[i], processes[j]}];
  }
  EXPECT_EQ(num_before.size(), 12u);
  for (const auto& [pair, number] : num_before) EXPECT_EQ(number, 20);
}

TEST(DrawnOrder, DependsOnTheSeedAlone) {
  DrawnOrder one(6, 1), again(6, 1), other(6, 2);
  bool differs = false;
  for (int round = 0; round < 10; ++round) {
    const std::vector<std::size_t> processes = one.next();
    EXPECT_EQ(processes, again.next());
    differs = differs || processes != other.next();
  }
  EXPECT_TRUE(differs);
}

// Returns the standard deviation of the logarithm of the ratio between the seconds of a one-second process
// and the seconds of the process before it.
double spread_of_neighbours(double noise) {
  SimulatedMachine machine(3, noise);
  std::vector<double> ratios;
  double before = machine.run(1);
  for (int i = 0; i < 20000; ++i) {
    const double now = machine.run(1);
    ratios.push_back(std::abs(std::log(now / before)));
    before = now;
  }
  return median(ratios) / 0.6745;
}

TEST(SimulatedMachine, HasTheNoiseOfAProcessThatIsAskedFor) {
  for (const double noise : {0.02, 0.045}) {
    EXPECT_GT(spread_of_neighbours(noise), noise * std::sqrt(2.0));
    EXPECT_LT(spread_of_neighbours(noise), 1.5 * noise * std::sqrt(2.0));
  }
}

}  // namespace
}  // namespace podm::bench
