// Tests of the stored crossover, and of rows that must not decide it.
#include "experiments/crossover.h"

#include <gtest/gtest.h>

#include <cmath>

#include "process/process.h"
#include "rows/results_file.h"
#include "tests/fake_mesher.h"
#include "tests/made_up_rows.h"

namespace podm::bench {
namespace {

// A run of a million cells per thread, at `rate` million cells per second.
Row row(const std::string& algorithm, int threads, double rate, const std::string& trial = "1M") {
  Row made = made_up_row(trial + ",algorithm=" + algorithm, {{"algorithm", algorithm}, {"threads", threads}});
  mesh_of(made).cells = static_cast<std::uint64_t>(threads) * 1'000'000;
  mesh_of(made).phases_s = {{"refine", threads / rate}, {"write", 99.0}};
  return made;
}

using Rates = std::vector<std::array<double, 2>>;  // of podm and podm-home at 1, 2, 4, ... threads

std::vector<std::vector<Row>> rows(const Rates& rates) {
  std::vector<std::vector<Row>> rows;
  int threads = 1;
  for (const auto& [podm, podm_home] : rates) {
    rows.push_back({row("podm", threads, podm)});
    rows.push_back({row("podm-home", threads, podm_home)});
    threads *= 2;
  }
  return rows;
}

std::optional<int> threads_of(const Rates& rates) { return crossover_of(rows(rates)).value().threads; }

TEST(Crossover, IsTheLeastNumberFromWhichOnPodmHomeStaysAhead) {
  EXPECT_EQ(threads_of({{1, 0.9}, {2, 1.9}, {3, 3.1}, {4, 5}}), 4);
  EXPECT_EQ(threads_of({{1, 1.1}, {2, 1.9}, {3, 3.1}}), 4) << "ahead once and behind again counts not";
  EXPECT_EQ(threads_of({{1, 1.1}, {2, 2.1}}), 1);
}

TEST(Crossover, NoneUpToTheMostThreadsMeasured) {
  const Crossover none = crossover_of(rows({{1, 0.9}, {2, 1.9}, {4, 3.9}})).value();
  EXPECT_FALSE(none.threads);
  EXPECT_EQ(none.measured_up_to, 4);
  EXPECT_NE(tell_crossover(none).find("up to 4"), std::string::npos);
  EXPECT_FALSE(threads_of({{1, 1.1}, {2, 1.9}})) << "behind where it was measured last";
}

TEST(Crossover, RepeatsThatOverlapAreNoEvidence) {
  auto repeats = rows({{1, 0.9}, {2, 2.1}});
  EXPECT_EQ(crossover_of(repeats).value().threads, 2);
  for (const double podm : {2.2, 1.9}) repeats.push_back({row("podm", 2, podm)});
  for (const double podm_home : {1.9, 2.2}) repeats.push_back({row("podm-home", 2, podm_home)});
  EXPECT_FALSE(crossover_of(repeats).value().threads);
}

TEST(Crossover, RoundsAreComparedWithThemselvesAndTellTheirCoverage) {
  std::vector<std::vector<Row>> rounds(2);
  for (int round = 1; round <= 6; ++round) {  // each half as fast as the round before
    const double rate = std::pow(0.5, round);
    rounds[0].push_back(row("podm", 1, rate));
    rounds[1].push_back(row("podm-home", 1, 1.1 * rate));
    for (auto& trial : rounds) trial.back().repeat = round;
  }
  const Crossover crossover = crossover_of(rounds).value();
  EXPECT_EQ(crossover.threads, 1);
  EXPECT_NEAR(crossover.measurements[0].ratio_interval[0], 1.1, 1e-12);
  EXPECT_NEAR(crossover.measurements[0].ratio_coverage, 31.0 / 32, 1e-12);
  EXPECT_EQ(crossover_of(rows({{1, 2}})).value().measurements[0].ratio_coverage, 0) << "one round";
}

TEST(Crossover, OnlyWhatRanOnThisMachineDecides) {
  for (const Json& simulated :
       {Json{{"executor", "virtual"}}, Json{{"topology", "x.xml"}}, Json{{"oversubscribe", true}}}) {
    auto all = rows({{1, 2}});
    for (auto& trial : all) trial.front().asked.update(simulated);
    EXPECT_FALSE(crossover_of(all)) << simulated;
  }
  auto warmup = rows({{1, 2}}), unmet = warmup, moved = warmup;
  moved[0].front().probe_moved = true;
  EXPECT_FALSE(crossover_of(moved)) << "it was not as fast for both";
  warmup[1].front().warmup = true;
  unmet[1].front().status = Status::kUnmet;
  EXPECT_FALSE(crossover_of(warmup));
  EXPECT_FALSE(crossover_of(unmet));
  EXPECT_FALSE(crossover_of({{row("podm", 1, 1)}, {row("auto", 1, 2)}, {row("podm-home", 2, 2)}}));
}

TEST(Crossover, TheTrialOfTheMostCellsAThreadDecides) {
  auto all = rows({{1, 2}, {2, 3}});
  for (const char* algorithm : {"podm", "podm-home"}) {
    Row larger = row(algorithm, 2, std::string(algorithm) == "podm" ? 2 : 1, "9M");
    mesh_of(larger).cells *= 9;
    all.push_back({larger});
  }
  const Crossover crossover = crossover_of(all).value();
  EXPECT_EQ(crossover.trial, "9M");
  EXPECT_FALSE(crossover.threads);
}

TEST(Crossover, NamesItsMachineWithoutItsMood) {
  const MachineRecord machine = crossover_of(rows({{1, 2}})).value().machine;
  EXPECT_EQ(machine, row("podm", 1, 1).environment);
  EXPECT_FALSE(to_json(machine).contains("load_average"));
}

// An experiment whose fake mesher takes 1 s, and half of it for podm-home.
TEST(CrossoverExperiment, StoresItsResultOnceAllHasRun) {
  const TemporaryFolder folder;
  const std::string experiment = folder.write("exp.toml", R"(title = "T"
claim = "C"
stores_crossover = true
[inputs.a]
image = "phantom:torus"
[[trials]]
name = "some"
input = "a"
algorithm = ["podm", "podm-home"]
)" + kClaim);
  std::string faster = kGoodRecord;
  faster.replace(faster.find("\"read\":0.5"), 10, "\"read\":0.1");
  const std::string podm =
      fake_mesher(folder, "case \"$(cat \"$(dirname \"$0\")/arguments\")\" in *podm-home*) echo '" + faster +
                              "';; *) echo '" + kGoodRecord + "';; esac > \"$record\"\n");
  // A run during which the machine changes its speed stores no crossover.
  for (int tries = 0; tries < 10 && !std::filesystem::exists(folder / "results/crossover.json"); ++tries) {
    const int exit_code = run_process({.arguments = {PODM_BENCH, "run", experiment, "--again", "--podm", podm,
                                                     "--results", folder / "results", "--verifier", "none"},
                                       .stdout_path = folder / "out",
                                       .stderr_path = folder / "err",
                                       .timeout_s = 60})
                              .exit_code;
    EXPECT_EQ(exit_code, 0) << read_tail(folder / "err", 1000);
  }
  EXPECT_NE(read_tail(folder / "out", 1000).find("PODM_CROSSOVER"), std::string::npos);
  std::ifstream file(folder / "results/crossover.json");
  const Json crossover = Json::parse(file, nullptr, false);
  ASSERT_TRUE(crossover.is_object());
  EXPECT_EQ(crossover["threads"], 1);
  EXPECT_FALSE(crossover["machine"]["cpu"].get<std::string>().empty());
}

}  // namespace
}  // namespace podm::bench
