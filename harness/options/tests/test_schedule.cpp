// Tests of the order of turns, of the keys of trials and of expected durations.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "experiments/expectation.h"
#include "experiments/progress.h"
#include "options/schedule.h"
#include "tests/fake_mesher.h"
#include "trials/trial_key.h"

namespace podm::bench {
namespace {

std::vector<Trial> some_trials() {
  std::vector<Trial> trials(6);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i].name = std::to_string(i);
    trials[i].image = "phantom:torus";
    trials[i].repeats = 4;
    trials[i].warmups = 1;
  }
  trials[2].repeats = 2;
  trials[3].warmups = 0;
  return trials;
}

TEST(Schedule, EveryTurnOccursOnceInItsRoundAndWarmUpsComeFirst) {
  const auto trials = some_trials();
  const auto turns = schedule(trials, 1);
  ASSERT_EQ(turns.size(), 5u * 4 + 2 + 5);
  std::set<std::tuple<bool, int, std::size_t>> seen;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Turn& turn = turns[i];
    const Trial& trial = trials.at(turn.trial);
    EXPECT_TRUE(seen.insert({turn.is_warmup, turn.repeat, turn.trial}).second);
    EXPECT_LE(turn.repeat, turn.is_warmup ? trial.warmups : trial.repeats);
    if (i == 0) continue;
    EXPECT_LE(turn.is_warmup, turns[i - 1].is_warmup);
    if (turn.is_warmup == turns[i - 1].is_warmup) {
      EXPECT_GE(turn.repeat, turns[i - 1].repeat);
    }
  }
}

TEST(Schedule, SeedAloneDecidesTheOrderAndRoundsDiffer) {
  const auto trials = some_trials();
  EXPECT_EQ(schedule(trials, 7), schedule(trials, 7));
  EXPECT_NE(schedule(trials, 7), schedule(trials, 8));
  std::set<std::vector<std::size_t>> orders;
  std::vector<std::size_t> order;
  for (const Turn& turn : schedule(std::vector<Trial>(20, trials[0]), 7)) {
    order.push_back(turn.trial);
    if (order.size() < 20) continue;
    orders.insert(order);
    order.clear();
  }
  EXPECT_EQ(orders.size(), 5u) << "each round has an order of its own";
}

class TrialKeysTest : public testing::Test {
 protected:
  static std::string key(const Trial& trial, const Turn& turn = {}, const std::string& mesher = "m",
                         const std::string& cpu = "c") {
    MachineRecord machine;
    machine.cpu = cpu;
    return TrialKeys(mesher, machine).of(trial, turn, prepared(trial));
  }
  TemporaryFolder folder_;
};

TEST_F(TrialKeysTest, DifferWithAllThatChangesAMeasurement) {
  Trial trial = some_trials()[0];
  trial.options = {{"threads", 1}, {"radius_mm", 2.0}};
  std::set<std::string> keys = {key(trial), key(trial, {0, 2, false}), key(trial, {0, 1, true}),
                                key(trial, {}, "other"), key(trial, {}, "m", "other")};
  const auto add_with = [&](const char* option, const Json& value) {
    Trial other = trial;
    other.options[option] = value;
    keys.insert(key(other));
  };
  add_with("threads", 2);
  add_with("radius_mm", 2.5);
  add_with("pin", true);
  Preparation preparation = prepared(trial);
  preparation.sha256 = "of another image";
  MachineRecord machine;
  machine.cpu = "c";
  keys.insert(TrialKeys("m", machine).of(trial, {}, preparation));
  EXPECT_EQ(keys.size(), 9u);
}

TEST_F(TrialKeysTest, AreThoseOfTheSameMeasurementElsewhere) {
  Trial trial = some_trials()[0];
  const std::string before = key(trial);
  trial.timeout_s = 5;
  trial.memory_limit_gib = 1;
  trial.repeats = 50;
  EXPECT_EQ(key(trial), before) << "limits and the number of repeats change no measurement";
  trial.image = "elsewhere.nii";
  EXPECT_EQ(key(trial), before) << "the file's bytes count, not its name";
}

TEST_F(TrialKeysTest, DifferWithTheRadiusThatWasFound) {
  Trial trial = some_trials()[0];
  trial.options = {{"threads", 1}, {"target_elements", 1000}};
  const auto key_with = [&](double radius_mm) {
    Preparation preparation = prepared(trial);
    preparation.resolved.emplace().radius_mm = radius_mm;
    return TrialKeys("m", {}).of(trial, {}, preparation);
  };
  EXPECT_EQ(key_with(2), key_with(2));
  EXPECT_NE(key_with(2), key_with(2.5));
}

TEST_F(TrialKeysTest, OfTrialsOnRanksDifferWithPodmMpi) {
  Trial alone = some_trials()[0], on_ranks = alone;
  on_ranks.options["ranks"] = 2;
  const auto key_beside = [&](const std::string& bytes, const Trial& trial) {
    folder_.write("podm-mpi", bytes);
    return TrialKeys("m", {}, {}, folder_ / "podm").of(trial, {}, prepared(trial));
  };
  EXPECT_NE(key_beside("one", on_ranks), key_beside("other", on_ranks));
  EXPECT_EQ(key_beside("one", alone), key_beside("other", alone));
}

TEST_F(TrialKeysTest, OfVirtualTimeAreThoseOfEveryMachine) {
  Trial trial = some_trials()[0];
  const auto key_on = [&](const std::string& cpu, std::uint64_t nodes) {
    MachineRecord machine;
    machine.cpu = cpu;
    machine.numa_nodes = nodes;
    machine.identity.emplace().vendor = cpu;
    return TrialKeys("m", machine).of(trial, {}, prepared(trial));
  };
  EXPECT_NE(key_on("one", 1), key_on("other", 1));
  trial.options["executor"] = "virtual";
  EXPECT_EQ(key_on("one", 1), key_on("other", 1));
  EXPECT_NE(key_on("one", 1), key_on("one", 2)) << "the workers are spread over the nodes";
  trial.options["topology"] = folder_.write("machine.toml", "x");
  EXPECT_EQ(key_on("one", 1), key_on("other", 2));
  trial.options = {{"counters", "cachegrind"}};
  EXPECT_NE(key_on("one", 1), key_on("other", 1)) << "where cachegrind is missing it is measured";
}

TEST_F(TrialKeysTest, IdentityCounts) {
  const Trial trial = some_trials()[0];
  const auto key_of_model = [&](std::uint64_t model) {
    MachineRecord machine;
    machine.cpu = "AMD EPYC";
    machine.identity.emplace().model = model;
    return TrialKeys("m", machine).of(trial, {}, prepared(trial));
  };
  EXPECT_EQ(key_of_model(17), key_of_model(17));
  EXPECT_NE(key_of_model(17), key_of_model(2));
}

TEST_F(TrialKeysTest, TopologyCountsByItsBytes) {
  Trial trial = some_trials()[0];
  trial.options["topology"] = folder_.write("machine.xml", "<topology/>");
  const std::string before = key(trial);
  folder_.write("machine.xml", "<topology></topology>");
  EXPECT_NE(key(trial), before);
}

TEST(Expectations, ComeFromRowsOfTheTrialThenFromTheFile) {
  Experiment experiment;
  experiment.trials = some_trials();
  experiment.expected_minutes = 9;
  Trial trial = experiment.trials[0];
  trial.options["target_elements"] = 1'000'000;
  EXPECT_DOUBLE_EQ(*Expectations(experiment, {}).of(trial).seconds, 9 * 60.0 / 27);
  EXPECT_GT(*Expectations(experiment, {}).of(trial).memory_bytes, 1e8);

  const auto row = [](double wall_s, Status status) {
    Row made;
    made.trial = "0";
    made.status = status;
    made.input.name = "phantom:torus";
    made.verification_s = 0.5;
    made.mesh_bytes = 700;
    made.process.wall_s = wall_s;
    made.process.peak_rss_bytes = static_cast<std::uint64_t>(5000 * wall_s);
    return made;
  };
  const Expectations known(experiment, {row(1, Status::kOk), row(3, Status::kUnmet), row(2, Status::kOk),
                                        row(99, Status::kTimedOut)});
  EXPECT_DOUBLE_EQ(*known.of(trial).seconds, 2.5);
  EXPECT_DOUBLE_EQ(*known.of(trial).memory_bytes, 15000);
  EXPECT_DOUBLE_EQ(*known.of(trial).disk_bytes, 700);
  trial.image = "phantom:sphere";
  EXPECT_DOUBLE_EQ(*known.of(trial).seconds, 20) << "rows of another image decide nothing";
}

TEST(Expectations, ShareTheMinutesByElements) {
  Experiment experiment;
  experiment.trials = {Trial{}, Trial{}};
  experiment.trials[0].options["target_elements"] = 100'000;
  experiment.trials[1].options["target_elements"] = 10'000'000;
  experiment.expected_minutes = 2;
  const Expectations expected(experiment, {});
  const double small_s = *expected.of(experiment.trials[0]).seconds;
  const double large_s = *expected.of(experiment.trials[1]).seconds;
  EXPECT_DOUBLE_EQ(small_s + large_s, 120);
  EXPECT_GT(large_s, 10 * small_s);
}

TEST(RemainingTime, FollowsExpectationsAndCorrectsThem) {
  RemainingTime remaining({10.0, 10.0, 30.0});
  EXPECT_DOUBLE_EQ(*remaining.seconds(0), 50);
  EXPECT_DOUBLE_EQ(*remaining.seconds(4), 46);
  EXPECT_DOUBLE_EQ(*remaining.seconds(99), 40) << "a turn that takes long still leaves the others";
  remaining.finish_turn(20);
  EXPECT_DOUBLE_EQ(*remaining.seconds(0), 80);
  remaining.finish_turn(20);
  remaining.finish_turn(60);
  EXPECT_DOUBLE_EQ(*remaining.seconds(0), 0);

  RemainingTime unknown({std::nullopt, std::nullopt});
  EXPECT_EQ(unknown.seconds(3), std::nullopt);
  unknown.finish_turn(5);
  EXPECT_DOUBLE_EQ(*unknown.seconds(0), 5);
}

}  // namespace
}  // namespace podm::bench
