// Tests of the program as a user runs it.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "options/schedule.h"
#include "process/sha256.h"
#include "rows/results_file.h"
#include "tests/bench_test.h"

namespace podm::bench {
namespace {

// Returns a seed with which trial "one" runs before trial "two".
std::string seed_with_one_first() {
  for (std::uint64_t seed = 0;; ++seed)
    for (const Turn& turn : schedule(std::vector<Trial>(3), seed)) {
      if (turn.trial == 0) return std::to_string(seed);
      if (turn.trial == 1) break;
    }
}

TEST_F(BenchTest, RecordsTheTrialsThatRanAndLeavesNoMesh) {
  EXPECT_EQ(run_with(good_mesh_), 0) << printed("err");
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two"}));
  EXPECT_TRUE(is_tidy());
  for (const char* word : {"one", "two", "three", "skipped", "absent.nii"})
    EXPECT_NE(printed("out").find(word), std::string::npos) << word;
}

TEST_F(BenchTest, SecondRunSkipsMeasuredTrialsUnlessAgainIsGiven) {
  run_with(good_mesh_);
  EXPECT_EQ(run_with(good_mesh_), 0);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two"}));
  EXPECT_TRUE(has_printed("err", "2 of them skipped: already in " + (folder_ / "results/exp.jsonl")));
  EXPECT_TRUE(has_printed("out", "two")) << "the table lists them too";
  EXPECT_EQ(run_with(good_mesh_, {"--only", "two", "--again"}), 0);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two", "two"}));
  EXPECT_EQ(run_with("# another mesher\n" + good_mesh_, {"--only", "one"}), 0);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "one", "two", "two"}));
}

TEST_F(BenchTest, OnlyFinishedTrialsAreSkippedAndUnmetOnesStayUnmet) {
  const std::string state = folder_.write("state", "exit 3");
  const std::string mesh_body = good_mesh_ + ". " + state + "\n";
  EXPECT_EQ(run_with(mesh_body, {"--only", "one"}), 1);
  folder_.write("state", "exit 1");
  EXPECT_EQ(run_with(mesh_body, {"--only", "one"}), 1);
  folder_.write("state", "exit 0");
  EXPECT_EQ(run_with(mesh_body, {"--only", "one"}), 1) << "still not met";
  ASSERT_EQ(rows().size(), 2u) << "a failure runs again, a mesh that is not met does not";
  EXPECT_EQ(rows()[0].at("status"), "failed");
  EXPECT_EQ(rows()[1].at("status"), "unmet");
}

TEST_F(BenchTest, RepeatsAreRoundsAndTheSeedDecidesTheirOrder) {
  std::string matrix = kExperiment;
  matrix.replace(matrix.find("radius_mm = 2"), 13, "radius_mm = [1, 2, 3]\nrepeats = 3\nwarmup = 1");
  folder_.write("exp.toml", matrix);
  const auto order_with = [&](const std::string& seed) {
    std::filesystem::remove_all(folder_ / "results");
    EXPECT_EQ(run_with(good_mesh_, {"--only", "two*", "--order-seed", seed}), 0) << printed("err");
    return in_order();
  };
  const auto order = order_with("5");
  ASSERT_EQ(order.size(), 12u);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto row = rows()[i];
    EXPECT_EQ(row.at("warmup"), i < 3);
    EXPECT_EQ(row.at("repeat"), i < 3 ? 1 : static_cast<int>(i / 3));
    EXPECT_EQ(row.at("order_seed"), 5);
  }
  EXPECT_EQ(order_with("5"), order);
  EXPECT_NE(order_with("6"), order);
}

TEST_F(BenchTest, KilledRunLosesTheRunningTrialAloneAndIsResumed) {
  folder_.write("slow", "");
  const std::string mesher = fake_mesher(folder_, R"script(
cd "$(dirname "$0")"
case $(cat arguments) in *--radius*) [ ! -e slow ] || { echo $$ > pid; exec sleep 60; } ;; esac
)script" + good_mesh_);
  const std::vector<std::string> arguments{PODM_BENCH, "run",          folder_ / "exp.toml", "--podm",
                                           mesher,     "--results",    folder_ / "results",  "--verifier",
                                           "none",     "--order-seed", seed_with_one_first()};
  const auto outcome = run_process(
      {.arguments = arguments, .stdout_path = {}, .stderr_path = folder_ / "err", .timeout_s = 60},
      [&] { return printed("pid").ends_with('\n'); });  // signal 9 kills it
  ASSERT_EQ(outcome.end, ProcessOutcome::End::kInterrupted) << printed("err");
  EXPECT_EQ(trials_recorded(), std::vector<std::string>{"one"});
  EXPECT_FALSE(is_tidy()) << "nobody could clean up";
  const std::string mesher_state = "/proc/" + std::to_string(std::stoi(printed("pid"))) + "/stat";
  const auto is_running = [&] {
    const std::string stat = read_tail(mesher_state, 1000);
    return !stat.empty() && stat.find(") Z") == std::string::npos;
  };
  for (int tries = 0; tries < 200 && is_running(); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(is_running()) << "the mesher outlives the harness";

  std::filesystem::remove(folder_ / "slow");
  EXPECT_EQ(bench({arguments.begin() + 1, arguments.end()}), 0) << printed("err");
  EXPECT_EQ(in_order(), (std::vector<std::string>{"one", "two"}));
  EXPECT_TRUE(has_printed("err", "1 of them skipped"));
  EXPECT_TRUE(is_tidy());
}

TEST_F(BenchTest, BrokenLastLineIsReportedAndMovedAside) {
  run_with(good_mesh_, {"--only", "one"});
  std::ofstream(folder_ / "results/exp.jsonl", std::ios::app) << R"({"schema":4,"key":")";
  EXPECT_EQ(run_with(good_mesh_), 0);
  EXPECT_TRUE(has_printed("err", "results/exp.jsonl:2: a broken line")) << printed("err");
  EXPECT_EQ(printed("results/exp.jsonl.broken"), "{\"schema\":4,\"key\":\"\n");
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two"}));
}

TEST_F(BenchTest, SecondRunAtTheSameTimeIsRefused) {
  const ResultsLock lock(folder_ / "results");
  EXPECT_EQ(run_with(good_mesh_), 2);
  EXPECT_TRUE(has_printed("err", folder_ / "results/.lock")) << printed("err");
  EXPECT_TRUE(rows().empty());
}

TEST_F(BenchTest, RowsOfAnotherSchemaAreRefused) {
  std::filesystem::create_directory(folder_ / "results");
  folder_.write("results/exp.jsonl", "{\"schema\":99}\n");
  EXPECT_EQ(run_with(good_mesh_), 2);
  EXPECT_TRUE(has_printed("err", "exp.jsonl:1: a row of schema 99")) << printed("err");
}

TEST_F(BenchTest, DryRunListsTheRunsAndDoesNothing) {
  EXPECT_EQ(run_with("touch \"$(dirname \"$0\")/ran\"\n", {"--dry-run"}), 0) << printed("err");
  for (const char* words : {"one", "two", "--radius 2", "absent.nii (absent)", "3 runs, 3 to do"})
    EXPECT_TRUE(has_printed("out", words)) << words << " in\n" << printed("out");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "ran"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
  run_with(good_mesh_);
  EXPECT_EQ(run_with(good_mesh_, {"--dry-run"}), 0);
  EXPECT_TRUE(has_printed("out", "3 runs, 1 to do")) << printed("out");
}

TEST_F(BenchTest, SeveralImagesAreInputsOfTheirOwn) {
  const std::string mine = folder_.write("mine.nii", "x"), yours = folder_.write("yours.nii", "y");
  EXPECT_EQ(run_with(good_mesh_, {"--only", "one*", "--image", mine, "--image", yours}), 0) << printed("err");
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one,input=mine.nii", "one,input=yours.nii"}));
  std::filesystem::create_directory(folder_ / "other");
  EXPECT_EQ(run_with(good_mesh_, {"--image", mine, "--image", folder_.write("other/mine.nii", "z")}), 2);
  EXPECT_TRUE(has_printed("err", "have the same name")) << printed("err");
}

TEST_F(BenchTest, AFolderStandsForTheLabelImagesInIt) {
  std::filesystem::create_directories(folder_ / "mine/below.nii");
  for (const char* name : {"b.nrrd", "a.nii.gz", "README.md", "data.raw"})
    folder_.write(std::string("mine/") + name, "x");
  EXPECT_EQ(run_with(good_mesh_, {"--only", "one*", "--image", folder_ / "mine"}), 0) << printed("err");
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one,input=a.nii.gz", "one,input=b.nrrd"}));
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_EQ(run_with(good_mesh_, {"--image", folder_ / "empty"}), 2);
  EXPECT_TRUE(has_printed("err", "empty: no label image in this folder")) << printed("err");
}

TEST_F(BenchTest, AnImageThatIsRefusedHasARowWithItsReasonAndTheOthersRun) {
  folder_.write("exp.toml", experiment_of(1, "phantom:torus", "smooth_voxels = 2\n" + kClaim));
  const std::string good = folder_.write("good.nii", "x"), odd = folder_.write("refused.nii", "y");
  EXPECT_EQ(run_with(good_mesh_, {"--image", odd, "--image", good}), 1);
  ASSERT_EQ(rows().size(), 2u);
  for (const auto& row : rows()) {
    const bool is_good = row.at("trial") == "some,input=good.nii";
    EXPECT_EQ(row.at("status"), is_good ? "ok" : "failed");
    EXPECT_EQ(row.at("process").at("exit_code"), is_good ? 0 : 2);
    EXPECT_EQ(row.at("stderr_tail"), is_good ? "" : "refused\n");
  }
  EXPECT_EQ(run_with(good_mesh_, {"--image", good}), 0);
  EXPECT_EQ(rows().size(), 3u) << "another trial's name";
  EXPECT_EQ(run_with(good_mesh_, {"--image", good}), 0);
  EXPECT_EQ(rows().size(), 3u) << "measured already";
}

TEST_F(BenchTest, LogsOfATrialAreKeptBesideItsRow) {
  EXPECT_EQ(run_with("echo heard >&2\n" + good_mesh_, {"--only", "one"}), 0) << printed("err");
  const std::string logs = folder_ / ("results/logs/" + rows().at(0).at("key").get<std::string>());
  EXPECT_EQ(read_tail(logs + "/stderr.txt", 100), "heard\n");
  EXPECT_EQ(read_tail(logs + "/record.jsonl", 10000), kGoodRecord + "\n");
}

TEST_F(BenchTest, ImageStandsForAllInputs) {
  EXPECT_EQ(run_with(good_mesh_, {"--image", folder_.write("mine.nii", "x")}), 0) << printed("err");
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "three", "two"}));
  for (const auto& row : rows()) EXPECT_EQ(row.at("command")[2], folder_ / "mine.nii");
  EXPECT_EQ(run_with(good_mesh_, {"--image", folder_ / "none.nii"}), 2);
  EXPECT_TRUE(has_printed("err", "none.nii"));
}

TEST_F(BenchTest, TierIncludesTheLowerOnes) {
  std::string tiers = kExperiment;
  tiers.replace(tiers.find("radius_mm = 2"), 13, "tier = 'kick-tires'");
  folder_.write("exp.toml", "tier = 'full'\n" + tiers);
  EXPECT_EQ(run_with(good_mesh_, {"--tier", "default"}), 0) << printed("err");
  EXPECT_EQ(trials_recorded(), std::vector<std::string>{"two"});
  EXPECT_EQ(run_with(good_mesh_, {"--tier", "full"}), 0);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(run_with(good_mesh_, {"--tier", "huge"}), 2);
}

TEST_F(BenchTest, RowsNameTheTopologyBesideThem) {
  run_with(good_mesh_);
  for (const auto& row : rows()) {
    const std::string hash = row.at("environment").at("topology_sha256");
    EXPECT_EQ(sha256_of_file(folder_ / "results/topology-" + hash + ".xml"), hash);
  }
}

TEST_F(BenchTest, MachineIsThatOfTheRowsAndIsProbed) {
  EXPECT_EQ(run_with(good_mesh_, {"--only", "one"}), 0) << printed("err");
  const auto environment = rows().at(0).at("environment");
  EXPECT_EQ(bench({"machine", "--json"}), 0) << printed("err");
  const auto machine = nlohmann::json::parse(printed("out"));
  for (const char* key :
       {"cpu", "packages", "numa_nodes", "cores", "processors", "usable_processors", "identity"})
    EXPECT_EQ(environment.at(key), machine.at(key)) << key;
  for (const char* value : {"chase_ns", "triad_gb_per_s", "integer_ns"})
    for (const auto& probe : {environment.at("probe"), machine.at("probe")})
      EXPECT_GT(probe.at(value), 0) << value;
  EXPECT_EQ(bench({"machine"}), 0);
  EXPECT_TRUE(has_printed("out", machine.at("identity").at("vendor"))) << printed("out");
  EXPECT_TRUE(has_printed("out", "ns per random load"));
}

TEST_F(BenchTest, KeepKeepsTheMesh) {
  EXPECT_EQ(run_with(good_mesh_, {"--only", "one", "--keep"}), 0);
  bool is_kept = false;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "results"))
    is_kept = is_kept || entry.path().filename() == "mesh.vtu";
  EXPECT_TRUE(is_kept);
}

TEST_F(BenchTest, FailedTrialIsRecordedTheOthersStillRunAndTheExitCodeReportsIt) {
  EXPECT_EQ(run_with("case $* in *--radius*) exit 3;; esac\n"), 1);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two"}));
  EXPECT_TRUE(is_tidy());
}

TEST_F(BenchTest, PromiseThatAnotherMesherBreaksIsRecordedAndNoFailure) {
  std::filesystem::create_directories(folder_ / "peers/other");
  folder_.script("peers/other/run", R"([ "$1" = --version ] && { echo 'Other 1.0, MIT'; exit 0; }
while [ $# -gt 0 ]; do
  case $1 in --output) output=$2;; esac
  shift
done
echo '{"mesh":"m","cells":9,"vertices":9,"phases_s":{"refine":1},"promises":["structure"]}' > $output/record.jsonl
echo mesh > $output/m
)");
  const std::string head =
      "title = 't'\nclaim = 'c'\n[inputs.a]\nimage = '" + folder_.write("a.nii", "x") + "'\n";
  const std::string verifier =
      fake_verifier(folder_, "echo '{\"claims\":{\"structure\":{\"verdict\":\"fail\"}}}' > \"$report\"\n");
  const auto run = [&](const std::string& trial) {
    folder_.write("exp.toml", head + "[[trials]]\nname = 'one'\ninput = 'a'\n" + trial + kClaim);
    return bench({"run", folder_ / "exp.toml", "--podm", fake_mesher(folder_, good_mesh_), "--results",
                  folder_ / "results", "--verifier", verifier, "--peers", folder_ / "peers"});
  };
  EXPECT_EQ(run("mesher = 'other'\n"), 0) << printed("err");
  EXPECT_EQ(rows().back().at("status"), "unmet");
  EXPECT_EQ(run(""), 1) << "our own count";
  EXPECT_EQ(rows().back().at("status"), "unmet");
}

TEST_F(BenchTest, InterruptEndsTheTrialRecordsItAndStops) {
  EXPECT_EQ(run_with("kill -INT $PPID; sleep 30"), 1);  // the signal that Ctrl-C sends to podm-bench
  ASSERT_EQ(rows().size(), 1u);
  EXPECT_EQ(rows()[0].at("status"), "interrupted");
  EXPECT_NE(printed("out").find("interrupted"), std::string::npos);
  EXPECT_TRUE(is_tidy());
}

TEST_F(BenchTest, BadUsageAndInputExitWithTwoAndRecordNothing) {
  const std::string path = folder_ / "exp.toml";
  EXPECT_EQ(bench({}), 2);
  EXPECT_EQ(bench({"fly"}), 2);
  EXPECT_EQ(bench({"run"}), 2);
  EXPECT_EQ(bench({"run", path, "--colour"}), 2);
  EXPECT_EQ(bench({"run", folder_ / "absent.toml"}), 2);
  EXPECT_EQ(run_with(good_mesh_, {"--only", "four"}), 2);
  EXPECT_TRUE(has_printed("err", "four")) << printed("err");
  folder_.write("exp.toml", "colour = 1\n" + kExperiment);
  EXPECT_EQ(run_with(good_mesh_), 2);
  EXPECT_NE(printed("err").find(path + ":1:1:"), std::string::npos) << printed("err");
  EXPECT_EQ(bench({"run", path, "--podm", folder_ / "absent", "--results", folder_ / "results"}), 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

TEST_F(BenchTest, ListShowsTitleAndTime) {
  EXPECT_EQ(bench({"list", folder_.path()}), 0);
  EXPECT_NE(printed("out").find("Some title"), std::string::npos);
  EXPECT_EQ(bench({"list", folder_ / "absent"}), 2);
}

}  // namespace
}  // namespace podm::bench
