// What is stored of who outran whom, and what may not decide it.
#include "experiments/crossover.h"

#include <gtest/gtest.h>

#include "fake_mesher.h"
#include "rows/results_file.h"
#include "trials/process.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

// A run of a million cells a thread, at so many million cells a second.
Json row(const std::string& algorithm, int threads, double rate, const std::string& trial = "1M") {
  const double cells = 1e6 * threads;
  return {{"trial", trial + ",algorithm=" + algorithm},
          {"status", "ok"},
          {"asked", {{"algorithm", algorithm}, {"threads", threads}}},
          {"input", {{"name", "image.nii"}}},
          {"cells", cells},
          {"phases_s", {{"refine", cells / (1e6 * rate)}, {"write", 99.0}}},
          {"environment", {{"cpu", "some"}, {"cores", 64}, {"load_average", 0.1}}}};
}

using Rates = std::vector<std::array<double, 2>>;  // of podm and pdr-podm at 1, 2, 4, ... threads

std::vector<std::vector<Json>> rows(const Rates& rates) {
  std::vector<std::vector<Json>> rows;
  int threads = 1;
  for (const auto& [podm, pdr_podm] : rates) {
    rows.push_back({row("podm", threads, podm)});
    rows.push_back({row("pdr-podm", threads, pdr_podm)});
    threads *= 2;
  }
  return rows;
}

Json threads_of(const Rates& rates) { return crossover_of(rows(rates))["threads"]; }

TEST(Crossover, IsTheLeastNumberFromWhichOnPdrPodmStaysAhead) {
  EXPECT_EQ(threads_of({{1, 0.9}, {2, 1.9}, {3, 3.1}, {4, 5}}), 4);
  EXPECT_EQ(threads_of({{1, 1.1}, {2, 1.9}, {3, 3.1}}), 4) << "ahead once and behind again counts not";
  EXPECT_EQ(threads_of({{1, 1.1}, {2, 2.1}}), 1);
}

TEST(Crossover, NoneUpToTheMostThreadsMeasured) {
  const Json none = crossover_of(rows({{1, 0.9}, {2, 1.9}, {4, 3.9}}));
  EXPECT_TRUE(none["threads"].is_null());
  EXPECT_EQ(none["measured_up_to"], 4);
  EXPECT_NE(tell_crossover(none).find("up to 4"), std::string::npos);
  EXPECT_TRUE(threads_of({{1, 1.1}, {2, 1.9}}).is_null()) << "behind where it was measured last";
}

TEST(Crossover, RepeatsThatOverlapAreNoEvidence) {
  auto repeats = rows({{1, 0.9}, {2, 2.1}});
  EXPECT_EQ(crossover_of(repeats)["threads"], 2);
  for (const double podm : {2.2, 1.9}) repeats.push_back({row("podm", 2, podm)});
  for (const double pdr_podm : {1.9, 2.2}) repeats.push_back({row("pdr-podm", 2, pdr_podm)});
  EXPECT_TRUE(crossover_of(repeats)["threads"].is_null());
}

TEST(Crossover, OnlyWhatRanOnThisMachineDecides) {
  for (const Json& simulated :
       {Json{{"executor", "virtual"}}, Json{{"topology", "x.xml"}}, Json{{"oversubscribe", true}}}) {
    auto all = rows({{1, 2}});
    for (auto& trial : all) trial.front()["asked"].update(simulated);
    EXPECT_TRUE(crossover_of(all).is_null()) << simulated;
  }
  for (const auto& [key, value] : {std::pair<const char*, Json>{"warmup", true}, {"status", "unmet"}}) {
    auto all = rows({{1, 2}});
    all[1].front()[key] = value;
    EXPECT_TRUE(crossover_of(all).is_null()) << key;
  }
  EXPECT_TRUE(crossover_of({{row("podm", 1, 1)}, {row("auto", 1, 2)}, {row("pdr-podm", 2, 2)}}).is_null());
}

TEST(Crossover, TheTrialOfTheMostCellsAThreadDecides) {
  auto all = rows({{1, 2}, {2, 3}});
  for (const char* algorithm : {"podm", "pdr-podm"}) {
    Json larger = row(algorithm, 2, std::string(algorithm) == "podm" ? 2 : 1, "9M");
    larger["cells"] = 9 * larger["cells"].get<double>();
    all.push_back({larger});
  }
  const Json crossover = crossover_of(all);
  EXPECT_EQ(crossover["trial"], "9M");
  EXPECT_TRUE(crossover["threads"].is_null());
}

TEST(Crossover, NamesItsMachineWithoutItsMood) {
  EXPECT_EQ(crossover_of(rows({{1, 2}}))["machine"], (Json{{"cpu", "some"}, {"cores", 64}}));
}

// An experiment whose fake mesher takes 1 s, pdr-podm half of it.
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
algorithm = ["podm", "pdr-podm"]
)" + kClaim);
  std::string faster = kGoodRecord;
  faster.replace(faster.find("\"read\":0.5"), 10, "\"read\":0.1");
  const std::string podm =
      fake_mesher(folder, "case \"$(cat \"$(dirname \"$0\")/arguments\")\" in *pdr-podm*) echo '" + faster +
                              "';; *) echo '" + kGoodRecord + "';; esac > \"$record\"\n");
  const int exit_code = run_process({.arguments = {PODM_BENCH, "run", experiment, "--podm", podm, "--results",
                                                   folder / "results", "--verifier", "none"},
                                     .stdout_path = folder / "out",
                                     .stderr_path = folder / "err",
                                     .timeout_s = 60})
                            .exit_code;
  EXPECT_EQ(exit_code, 0) << read_tail(folder / "err", 1000);
  EXPECT_NE(read_tail(folder / "out", 1000).find("PODM_CROSSOVER"), std::string::npos);
  std::ifstream file(folder / "results/crossover.json");
  const Json crossover = Json::parse(file, nullptr, false);
  ASSERT_TRUE(crossover.is_object());
  EXPECT_EQ(crossover["threads"], 1);
  EXPECT_FALSE(crossover["machine"]["cpu"].get<std::string>().empty());
}

}  // namespace
}  // namespace podm::bench
