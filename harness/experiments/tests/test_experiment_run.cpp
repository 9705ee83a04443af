// Tests of the rounds of an experiment whose machine changes its speed, with a synthetic mesher and synthetic
// probes.
#include "experiments/experiment_run.h"

#include <gtest/gtest.h>

#include <deque>

#include "experiments/round_probes.h"
#include "experiments/verdicts.h"
#include "process/sha256.h"
#include "rows/machine_state.h"
#include "rows/results_file.h"
#include "tests/fake_mesher.h"

namespace podm::bench {
namespace {

ProbeRecord at_speed(double speed) { return {100 / speed, 10 * speed, 0.4 / speed}; }

// A source of these speeds in turn. A run's first probe sees only the first speed.
class Speeds {
 public:
  explicit Speeds(std::vector<double> speeds) : speeds_(speeds.begin(), speeds.end()) {
    speeds_.insert(speeds_.begin(), RoundProbes::kFirstRepeats - 1, speeds.front());
  }
  ProbeSource source() {
    return [this] {
      ++num_taken_;
      const double speed = speeds_.front();
      if (speeds_.size() > 1) speeds_.pop_front();
      return Probe(at_speed(speed));
    };
  }
  /// Returns the number of probes; the run's first one counts once.
  int num_probes() const { return std::max(0, num_taken_ - RoundProbes::kFirstRepeats + 1); }

 private:
  int num_taken_ = 0;
  std::deque<double> speeds_;
};

TEST(RoundProbes, TheEndOfARoundIsTheStartOfTheNext) {
  Speeds speeds({1, 2, 3, 4});
  RoundProbes probes(speeds.source());
  EXPECT_EQ(probes.begin(), Probe(at_speed(1)));
  EXPECT_EQ(probes.end(), Probe(at_speed(2)));
  EXPECT_EQ(probes.begin(), Probe(at_speed(2)));
  EXPECT_EQ(probes.end(), Probe(at_speed(3)));
  probes.pass();
  EXPECT_EQ(probes.begin(), Probe(at_speed(4))) << "time has gone by";
}

TEST(RoundProbes, AProbeThatIsDisturbedForAMomentIsRepeated) {
  Speeds speeds({1, 0.5, 0.7, 0.95, 0.5});
  RoundProbes probes(speeds.source());
  probes.begin();
  EXPECT_EQ(probes.end(), Probe(at_speed(0.95))) << "within the tolerance of the best";
  EXPECT_EQ(speeds.num_probes(), 4);
}

TEST(RoundProbes, WithoutRepeatsEachProbeIsMeasuredOnce) {
  Speeds speeds({1, 0.5});
  RoundProbes probes(speeds.source(), false);
  probes.begin();
  probes.end();
  EXPECT_EQ(speeds.num_probes(), 0) << "two measurements are fewer than those of a first probe";
}

TEST(RoundProbes, AMachineThatStaysSlowShows) {
  Speeds speeds({1, 0.5});
  RoundProbes probes(speeds.source());
  const Probe begin = probes.begin(), end = probes.end();
  EXPECT_TRUE(has_moved({begin, end}));
  EXPECT_EQ(speeds.num_probes(), 1 + RoundProbes::kMostRepeats);
  EXPECT_FALSE(has_moved({probes.begin(), probes.end()})) << "it is as slow at both ends of the next round";
}

TEST(RoundProbes, WhatIsUnavailableDoesNotMove) {
  const Probe known = at_speed(1), other = at_speed(1.2), unknown = Unavailable{"why"};
  EXPECT_TRUE(has_moved({known, unknown, other}));
  EXPECT_FALSE(has_moved({known, unknown, known}));
  EXPECT_FALSE(has_moved({unknown, unknown}));
  EXPECT_FALSE(has_moved({}));
}

class ExperimentRunTest : public testing::Test {
 protected:
  // Writes an experiment with two trials of `repeats` rounds on an image, and a claim on the ratio of their
  // times.
  void write_experiment(int repeats, const std::string& more = "") {
    const std::string claim = R"([[claims]]
name = "alike"
statement = "Both seeds take as long."
basis = "measured"
kind = "ratio"
value = "refining_seconds"
of = {seed = 2}
over = {seed = 1}
at_most = 1.5
)";
    folder_.write("exp.toml",
                  experiment_of(repeats, folder_.write("a.nii", "x"), "seed = [1, 2]\n" + more + claim));
  }
  void run(
      Speeds& speeds, const StopQuery& is_interrupted = [] { return false; }) {
    RunCommand command;
    command.experiment_paths = {folder_ / "exp.toml"};
    command.results_folder = folder_ / "results";
    command.programs.podm =
        fake_mesher(folder_, "echo mesh > \"$output\"; echo '" + kGoodRecord + "' > \"$record\"\n");
    std::filesystem::create_directories(command.results_folder);
    Session session(command, sha256_of_file(command.programs.podm), this_machine(), is_interrupted);
    session.probes = RoundProbes(speeds.source());
    const Experiment experiment = read_experiment(folder_ / "exp.toml");
    run_experiment(session, experiment,
                   make_plan(command, experiment, rows(), session.preparer, session.keys));
  }
  std::vector<Row> rows() const { return read_rows(folder_ / "results/exp.jsonl").rows; }
  std::vector<int> rounds_marked() const {
    std::vector<int> rounds;
    for (const Row& row : rows())
      if (probe_moved(row)) rounds.push_back(row.repeat);
    std::sort(rounds.begin(), rounds.end());
    return rounds;
  }
  Judgement judgement() const {
    const Experiment experiment = read_experiment(folder_ / "exp.toml");
    return judge(experiment, rows()).judgements.at(0);
  }
  TemporaryFolder folder_;
};

TEST_F(ExperimentRunTest, RowsCarryTheProbeOfTheirRoundAndDriftBetweenRoundsIsNoFault) {
  write_experiment(6);
  Speeds speeds({1, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3});
  run(speeds);
  ASSERT_EQ(rows().size(), 12u);
  EXPECT_EQ(speeds.num_probes(), 7);
  for (const Row& row : rows()) {
    EXPECT_EQ(row.environment.probe, Probe(at_speed(0.95 + 0.05 * row.repeat))) << row.repeat;
    EXPECT_FALSE(row.probe_moved);
    EXPECT_TRUE(row.environment.busy_elsewhere);
  }
  EXPECT_EQ(judgement().verdict, Verdict::kHolds) << judgement().reason;
}

TEST_F(ExperimentRunTest, ARoundWithinWhichTheSpeedMovedIsMarkedAndKept) {
  write_experiment(7);
  Speeds speeds({1, 1, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5});
  run(speeds);
  ASSERT_EQ(rows().size(), 14u);
  EXPECT_EQ(rounds_marked(), (std::vector<int>{2, 2}));
  for (const Row& row : rows())
    EXPECT_EQ(row.environment.probe_after,
              probe_moved(row) ? std::optional<Probe>(at_speed(1.5)) : std::nullopt);
  EXPECT_EQ(judgement().verdict, Verdict::kHolds) << judgement().reason;
  EXPECT_EQ(judgement().num_rows, 12u) << "those of the marked round are left out";
}

TEST_F(ExperimentRunTest, WithoutARoundThatCountsTheReasonIsTheMachine) {
  write_experiment(1);
  Speeds speeds({1, 0.8});
  run(speeds);
  EXPECT_EQ(judgement().verdict, Verdict::kCannotBeDecided);
  EXPECT_NE(judgement().reason.find("the machine's speed moved during each round"), std::string::npos)
      << judgement().reason;
}

TEST_F(ExperimentRunTest, ARoundThatIsResumedIsJudgedByTheProbesOfBothRuns) {
  write_experiment(2);
  Speeds before({1}), after({1.3});
  run(before, [this] { return rows().size() == 1; });  // an interrupt within the first round
  ASSERT_EQ(rows().size(), 1u);
  EXPECT_TRUE(rounds_marked().empty()) << "nobody saw its end";
  run(after);
  ASSERT_EQ(rows().size(), 4u);
  EXPECT_EQ(rounds_marked(), (std::vector<int>{1, 1})) << "the row of the run before is marked too";
  EXPECT_EQ(after.num_probes(), 3);
}

TEST_F(ExperimentRunTest, SimulatedTrialsNeedNoProbe) {
  write_experiment(2, "executor = \"virtual\"\n");
  std::string text = read_tail(folder_ / "exp.toml", 10'000);
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"\"measured\"", "\"simulated\""},
                                 {"\"refining_seconds\"", "\"virtual_refining_seconds\""}})
    text.replace(text.find(from), from.size(), to);
  folder_.write("exp.toml", text);
  Speeds speeds({1, 2});
  run(speeds);
  ASSERT_EQ(rows().size(), 4u);
  EXPECT_EQ(speeds.num_probes(), 0);
  for (const Row& row : rows()) {
    EXPECT_FALSE(row.environment.probe);
    EXPECT_FALSE(row.environment.busy_elsewhere);
  }
}

}  // namespace
}  // namespace podm::bench
