// How often the gate errs, on a simulated machine; what its tiers block; its file of budgets.
#include "gate/gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "gate/gate_budget.h"
#include "gate/gate_slowdown.h"
#include "tests/fake_mesher.h"

namespace podm::bench {
namespace {

// A shared machine: its speed wanders by 1.6 within an hour and jumps every five minutes or so, each process
// has noise of its own, and one in ten is disturbed by a quarter more or less.
class SimulatedMachine {
 public:
  SimulatedMachine(std::uint64_t seed, double noise) : random_(seed), noise_(noise) {
    wander_ = kWander * gauss();
  }

  // Seconds that a process of `seconds` on the average machine takes now.
  double run(double seconds) {
    const double kept = std::exp(-seconds / 600);
    wander_ = kept * wander_ + kWander * std::sqrt(1 - kept * kept) * gauss();
    if (uniform() < seconds / 300) jump_ = kWander * gauss();
    const double disturbance = uniform() < 0.1 ? -0.25 * std::log1p(-uniform()) : 0;
    return seconds * std::exp(wander_ + jump_ + noise_ * gauss() + disturbance);
  }
  Round round(double head_over_base) {
    Round round;
    std::array<int, 3> order{0, 1, 2};
    std::shuffle(order.begin(), order.end(), random_);
    for (const int which : order) {
      double& seconds = which == 0 ? round.base_s : which == 1 ? round.base_again_s : round.head_s;
      seconds = run(which == 2 ? 2 * head_over_base : 2);
    }
    return round;
  }

 private:
  static constexpr double kWander = 0.12;  // plus or minus two of it: a factor of 1.6

  double gauss() { return normal_(random_); }
  double uniform() { return std::uniform_real_distribution<double>()(random_); }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double noise_, wander_ = 0, jump_ = 0;
};

constexpr int kTries = 200;
constexpr std::uint64_t kFirstSeed = 1'000'000;  // far from those that the rule was chosen on

struct Counts {
  int slower = 0, not_slower = 0, cannot_tell = 0;
};

Counts answers_of(int num_tries, double head_over_base, double noise) {
  Counts counts;
  for (int i = 0; i < num_tries; ++i) {
    SimulatedMachine machine(kFirstSeed + static_cast<std::uint64_t>(i), noise);
    const Answer answer = measure_slowdown([&] { return machine.round(head_over_base); }).answer;
    counts.slower += answer == Answer::kSlower;
    counts.not_slower += answer == Answer::kNotSlower;
    counts.cannot_tell += answer == Answer::kCannotTell;
  }
  return counts;
}

TEST(Slowdown, OfTenPercentBlocksInNineteenOfTwentyTries) {
  for (const double noise : {0.02, 0.03, 0.045})
    EXPECT_GE(answers_of(kTries, 1.1, noise).slower, kTries * 19 / 20) << noise;
}

TEST(Slowdown, OfNothingNeverBlocks) {
  for (const double noise : {0.02, 0.03, 0.045}) {
    const Counts counts = answers_of(kTries, 1, noise);
    EXPECT_EQ(counts.slower, 0) << noise;
    EXPECT_GE(counts.not_slower, kTries * 9 / 10) << noise;
  }
}

TEST(Slowdown, IsNotTakenFromAGainNorFromNoiseAlone) {
  EXPECT_EQ(answers_of(kTries, 0.8, 0.03).not_slower, kTries);
  const Counts lost_in_noise = answers_of(20, 1, 0.4);
  EXPECT_EQ(lost_in_noise.slower, 0);
  EXPECT_GT(lost_in_noise.cannot_tell, 10);
}

TEST(Slowdown, AsksForFewRoundsWhenTheyAgreeAndForAllWhenTheyDoNot) {
  const Slowdown clear = measure_slowdown([] { return Round{1, 1, 1.2}; });
  EXPECT_EQ(clear.answer, Answer::kSlower);
  EXPECT_EQ(clear.num_rounds, kFewestRounds);
  EXPECT_NEAR(clear.head.value, 1.2, 1e-12);
  int num_rounds = 0;
  const Slowdown unclear = measure_slowdown([&] { return Round{1, 1, ++num_rounds % 2 == 0 ? 0.8 : 1.3}; });
  EXPECT_EQ(unclear.answer, Answer::kCannotTell);
  EXPECT_EQ(unclear.num_rounds, kMostRounds);
  EXPECT_EQ(num_rounds, kMostRounds);
}

TEST(Slowdown, SmallerThanTheDifferenceOfTheBaseToItselfIsNoEvidence) {
  EXPECT_NE(measure_slowdown([] { return Round{1, 1.2, 1.2}; }).answer, Answer::kSlower);
}

TEST(Work, DifferencesNameEachValueThatChangedCameOrWent) {
  const auto committed = from_json<Work>({{"cells", 10}, {"insertions", {{"R1", 3}, {"R2", 4}}}});
  EXPECT_TRUE(differences(committed, committed).empty());
  const auto measured = from_json<Work>({{"cells", 10}, {"insertions", {{"R1", 5}, {"R3", 6}}}});
  EXPECT_EQ(differences(committed, measured),
            (std::vector<std::string>{"insertions/R1: 5, committed 3", "insertions/R2: null, committed 4",
                                      "insertions/R3: 6, committed null"}));
}

// A mesher that proves its mesh and does the work {"cells":1000,...}; `tail` is the end of its record.
class GateTest : public testing::Test {
 protected:
  GateTest() {
    folder_.write("budgets.json", R"({"schema":1,"build":"","instructions_tolerance":0.5,
      "timed":{"name":"t","image":"phantom:torus","radius_mm":3},
      "budgets":[{"name":"one","image":"phantom:torus","radius_mm":3,"instructions":1,"work":{}}]})");
  }
  GateOptions options(const std::string& mesher, std::vector<int> tiers) {
    return {.head = mesher, .base = {}, .budgets_path = folder_ / "budgets.json", .tiers = std::move(tiers)};
  }
  std::string mesher(const std::string& tail, const std::string& body = "") {
    std::string record = kGoodRecord;
    record.back() = ',';
    return fake_mesher(folder_, body + "echo '" + record + tail + "}' > \"$record\"\n");
  }
  const std::string proved_ = R"("verdicts":{"size":"pass"},"counters":{"conflict_tests":5})";
  TemporaryFolder folder_;
};

TEST_F(GateTest, WorkAsCommittedPassesAndAnyOtherBlocks) {
  renew_budgets(options(mesher(proved_), {}), {});
  EXPECT_EQ(read_budgets(folder_ / "budgets.json").budgets.at(0).work.conflict_tests, 5u);
  EXPECT_TRUE(gate(options(mesher(proved_), {1}), {}));
  EXPECT_FALSE(
      gate(options(mesher(R"("verdicts":{"size":"pass"},"counters":{"conflict_tests":6})"), {1}), {}));
}

TEST_F(GateTest, UnprovedMeshBlocksAndIsNoBudget) {
  renew_budgets(options(mesher(proved_), {}), {});
  for (const char* verdicts : {R"({"size":"fail"})", R"({"size":"not_run"})", "{}"}) {
    const std::string unproved =
        mesher(std::string(R"("counters":{"conflict_tests":5},"verdicts":)") + verdicts);
    EXPECT_FALSE(gate(options(unproved, {1}), {})) << verdicts;
    EXPECT_THROW(renew_budgets(options(unproved, {}), {}), InputError) << verdicts;
  }
  EXPECT_FALSE(gate(options(mesher(proved_, "exit 3\n"), {1}), {}));
}

TEST_F(GateTest, MoreInstructionsThanTheBudgetAllowsBlock) {
  renew_budgets(options(mesher(proved_), {}), {});
  EXPECT_FALSE(gate(options(mesher(proved_, "i=0; while [ $i -lt 20000 ]; do i=$((i+1)); done\n"), {1}), {}));
}

TEST_F(GateTest, SecondsAreAskedOfBothMeshersAndAFailureIsNoAnswer) {
  GateOptions both = options(mesher(proved_), {2});
  both.base = both.head;
  EXPECT_NO_THROW(gate(both, {}));
  both.base = folder_.script("broken", "exit 3\n");
  EXPECT_THROW(gate(both, {}), InputError);
  EXPECT_THROW(gate(options(folder_ / "absent", {1}), {}), InputError);
  EXPECT_THROW(gate(options(mesher(proved_), {1}), [] { return true; }), InputError) << "stopped by the user";
}

TEST_F(GateTest, BrokenBudgetsAreRefusedByName) {
  for (const char* text : {"", "[]", "{", R"({"schema":2})", R"({"schema":1,"build":""})"}) {
    const std::string path = folder_.write("budgets.json", text);
    try {
      read_budgets(path);
      ADD_FAILURE() << text;
    } catch (const InputError& fault) {
      EXPECT_NE(std::string(fault.what()).find(path), std::string::npos) << fault.what();
    }
  }
  EXPECT_THROW(read_budgets(folder_ / "absent.json"), InputError);
}

TEST_F(GateTest, BudgetsAreReadAsWritten) {
  const Budgets written = read_budgets(folder_ / "budgets.json");
  write_budgets(written, folder_ / "again.json");
  const Budgets read = read_budgets(folder_ / "again.json");
  EXPECT_EQ(read.timed.image, written.timed.image);
  EXPECT_EQ(read.instructions_tolerance, written.instructions_tolerance);
  ASSERT_EQ(read.budgets.size(), 1u);
  EXPECT_EQ(read.budgets[0].trial.radius_mm, 3);
  EXPECT_EQ(read.budgets[0].instructions, 1u);
}

}  // namespace
}  // namespace podm::bench
