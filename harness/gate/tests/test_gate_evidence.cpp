// Tests of recorded rounds, of the faults for which they are refused, and of the gate's rule on them.
#include "gate/gate_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "errors.h"
#include "rows/codec.h"
#include "tests/fake_mesher.h"

namespace podm::bench {
namespace {

std::vector<Round> same_rounds(int num_rounds, Round round) {
  return std::vector<Round>(static_cast<std::size_t>(num_rounds), round);
}

TEST(ReplayedAnswers, StartWhereTheOneBeforeEndedAndLeaveOutWhatHasNoAnswer) {
  const std::vector<Round> rounds = same_rounds(3 * kLooks.front() - 1, {1, 1.2});
  const std::vector<Slowdown> apart = replayed_answers(rounds, false);
  ASSERT_EQ(apart.size(), 2u);
  for (const Slowdown& slowdown : apart) EXPECT_EQ(slowdown.answer, Answer::kSlower);
}

TEST(ReplayedAnswers, OverlappingStartAtEachRoundThatHasEnoughAfterIt) {
  const int num_rounds = 3 * kLooks.front() - 1;
  EXPECT_EQ(replayed_answers(same_rounds(num_rounds, {1, 1.2}), true).size(),
            static_cast<std::size_t>(num_rounds - kLooks.front() + 1));
}

TEST(ReplayedAnswers, ChangeWhereTheRoundsDo) {
  std::vector<Round> rounds = same_rounds(kLooks.front(), {1, 1.2});
  for (const Round& round : same_rounds(kLooks.front(), {1, 1})) rounds.push_back(round);
  const std::vector<Slowdown> answers = replayed_answers(rounds, false);
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0].answer, Answer::kSlower);
  EXPECT_EQ(answers[1].answer, Answer::kNotSlower);
}

GateRound synthetic_round(int number) {
  GateRound round;
  round.round = number;
  round.trial = {"t", "phantom:torus", 3};
  round.processes = {{false, 0, 1, 4}};
  for (const int percent : kPlantedPercent)
    round.processes.push_back({true, percent, 1 + percent / 100.0, 4});  // the wall seconds have no slowdown
  round.podm.sha256 = "aa";
  return round;
}

TEST(MeasuredTries, CompareTheSecondsOfTheClockAskedForWithTheBaseOfTheRound) {
  std::vector<GateRound> rounds;
  for (int i = 0; i < 4 * kLooks.front(); ++i) rounds.push_back(synthetic_round(i + 1));
  const std::vector<GateTries> all = measured_tries(rounds);
  EXPECT_EQ(all.size(), 4 * kPlantedPercent.size());
  for (const GateTries& row : all) {
    const bool is_slower = row.clock == "processor" && row.planted_percent > 1;
    EXPECT_EQ(row.slower, is_slower ? row.tries : 0) << table_of({row});
    EXPECT_EQ(row.not_slower, is_slower ? 0 : row.tries) << table_of({row});
    EXPECT_EQ(row.median_rounds, kLooks.front());
    EXPECT_EQ(row.slower_share_low.has_value(), row.starts == "apart");
    EXPECT_EQ(row.tries, row.starts == "apart" ? 4 : 3 * kLooks.front() + 1);
  }
}

class GateRoundsTest : public testing::Test {
 protected:
  // A mesher that takes a few milliseconds.
  std::string mesher() {
    return fake_mesher(folder_, "i=0; while [ $i -lt 3000 ]; do i=$((i+1)); done; echo '" + kGoodRecord +
                                    "' > \"$record\"\n");
  }
  RecordingOptions recording(int num_rounds) {
    return {
        .podm = mesher(), .rounds_path = path_, .trial = {"t", "phantom:torus", 3}, .num_rounds = num_rounds};
  }
  void write(const std::vector<GateRound>& rounds) {
    std::ofstream file(path_);
    for (const GateRound& round : rounds) file << to_json(round).dump() << "\n";
  }
  // Expects that reading the file fails at the line.
  void expect_refused_at(int line, const std::string& words) {
    try {
      read_gate_rounds(path_);
      ADD_FAILURE() << words;
    } catch (const InputError& fault) {
      const std::string text = fault.what();
      EXPECT_EQ(text.find(path_ + ":" + std::to_string(line) + ": "), 0u) << text;
      EXPECT_NE(text.find(words), std::string::npos) << text;
    }
  }
  TemporaryFolder folder_;
  const std::string path_ = folder_ / "rounds.jsonl";
};

TEST_F(GateRoundsTest, RecordedHaveEachSlowdownOnceAndGoOnWhereTheyEnded) {
  record_gate_rounds(recording(2), {});
  record_gate_rounds(recording(1), {});
  const std::vector<GateRound> rounds = read_gate_rounds(path_);
  ASSERT_EQ(rounds.size(), 3u);
  for (std::size_t i = 0; i < rounds.size(); ++i) EXPECT_EQ(rounds[i].round, static_cast<int>(i) + 1);
  const auto percents = [](const GateRound& round) {
    std::vector<std::pair<bool, int>> order;
    for (const GateProcess& process : round.processes)
      order.emplace_back(process.is_head, process.planted_percent);
    return order;
  };
  auto reversed = percents(rounds[1]);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(percents(rounds[0]), reversed);
}

TEST_F(GateRoundsTest, OfNoWholeRoundAreRefusedByTheirLine) {
  write({synthetic_round(1), synthetic_round(2)});
  EXPECT_EQ(read_gate_rounds(path_).size(), 2u);
  std::ofstream(path_, std::ios::app) << "{\"schema\":1\n";
  expect_refused_at(3, "");
  GateRound other = synthetic_round(2);
  other.processes.pop_back();
  write({synthetic_round(1), other});
  expect_refused_at(2, "number of processes");
  other = synthetic_round(2);
  other.processes[1].planted_percent = 4;
  write({synthetic_round(1), other});
  expect_refused_at(2, "one head with 0 % planted");
  other = synthetic_round(2);
  other.processes[0].cpu_s = 0;
  write({synthetic_round(1), other});
  expect_refused_at(2, "one base");
  EXPECT_THROW(read_gate_rounds(folder_ / "absent"), InputError);
}

TEST_F(GateRoundsTest, OfTwoMachinesMeshersOrTrialsAreRefused) {
  GateRound other = synthetic_round(2);
  other.environment.usable_processors = 99;
  write({synthetic_round(1), other});
  expect_refused_at(2, "another machine");
  other = synthetic_round(2);
  other.podm.sha256 = "bb";
  write({synthetic_round(1), other});
  expect_refused_at(2, "another mesher");
  other = synthetic_round(2);
  other.trial.radius_mm = 4;
  write({synthetic_round(1), other});
  expect_refused_at(2, "another trial");
  write({synthetic_round(1)});
  EXPECT_THROW(record_gate_rounds(recording(1), {}), InputError) << "the rounds are of another machine";
}

std::string text_of_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// Reads the counts in the folders `gate` of the committed results. Counts of recorded rounds are computed
// again.
TEST(CommittedEvidence, IsReadAndWrittenAsItWasAndFollowsFromItsRounds) {
  int num_files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(PODM_RESULTS "/reference")) {
    const std::filesystem::path path = entry.path();
    if (path.parent_path().filename() != "gate" || path.extension() != ".jsonl") continue;
    ++num_files;
    std::string lines;
    if (path.filename() == "rounds.jsonl") {
      for (const GateTries& row : measured_tries(read_gate_rounds(path))) lines += to_json(row).dump() + "\n";
      EXPECT_EQ(lines, text_of_file(path.parent_path() / "tries.jsonl"));
    } else {
      std::ifstream file(path);
      for (std::string line; std::getline(file, line);)
        lines += to_json(from_json<GateTries>(Json::parse(line))).dump() + "\n";
      EXPECT_EQ(lines, text_of_file(path));
    }
  }
  EXPECT_GT(num_files, 0);
}

TEST(PlantedSlowdown, TakesItsShareOfTheProcessorSecondsAndAddsWhatItTook) {
  GateProcess process{.is_head = true, .planted_percent = 10, .cpu_s = 0.2, .wall_s = 0.5};
  plant(process);
  EXPECT_GE(process.cpu_s, 0.22);
  EXPECT_LT(process.cpu_s, 0.23);
  EXPECT_GE(process.wall_s, 0.519) << "one thread takes no more processor seconds than pass on the clock";
  GateProcess same{.is_head = true, .planted_percent = 0, .cpu_s = 0.2, .wall_s = 0.5};
  plant(same);
  EXPECT_EQ(same.cpu_s, 0.2);
  EXPECT_EQ(same.wall_s, 0.5);
}

}  // namespace
}  // namespace podm::bench
