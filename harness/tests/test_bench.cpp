// The program as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "fake_mesher.h"
#include "process.h"

namespace podm::bench {
namespace {

const std::string kExperiment = R"(title = "Some title"
claim = "C"
[inputs.a]
image = "phantom:torus"
[inputs.b]
image = "absent.nii"
if_exists = true
[[trials]]
name = "one"
input = "a"
[[trials]]
name = "two"
input = "a"
radius_mm = 2
[[trials]]
name = "three"
input = "b"
)";

class BenchTest : public testing::Test {
 protected:
  BenchTest() { folder_.write("exp.toml", kExperiment); }

  // Exit code of podm-bench; what it prints is in the files "out" and "err".
  int bench(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), PODM_BENCH);
    return run_process({.arguments = arguments,
                        .stdout_path = folder_ / "out",
                        .stderr_path = folder_ / "err",
                        .timeout_s = 60})
        .exit_code;
  }
  int run_with(const std::string& mesh_body, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{
        "run",       folder_ / "exp.toml", "--podm",     fake_mesher(folder_, mesh_body),
        "--results", folder_ / "results",  "--verifier", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench(arguments);
  }
  std::string printed(const std::string& name) { return read_tail(folder_ / name, 10000); }
  std::vector<std::string> trials_recorded() {
    std::ifstream file(folder_ / "results/exp.jsonl");
    std::vector<std::string> trials;
    for (std::string line; std::getline(file, line);)
      trials.push_back(nlohmann::json::parse(line).at("trial"));
    return trials;
  }
  std::size_t files_in_results() {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "results"))
      files += entry.is_regular_file();
    return files;
  }
  const std::string good_mesh_ = "echo mesh > \"$output\"; echo '" + kGoodRecord + "' > \"$record\"\n";
  TemporaryFolder folder_;
};

TEST_F(BenchTest, RecordsTheTrialsThatRanAndLeavesNoMesh) {
  EXPECT_EQ(run_with(good_mesh_), 0) << printed("err");
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(files_in_results(), 1u);
  for (const char* word : {"one", "two", "three", "skipped", "absent.nii"})
    EXPECT_NE(printed("out").find(word), std::string::npos) << word;
}

TEST_F(BenchTest, SecondRunAppends) {
  run_with(good_mesh_);
  EXPECT_EQ(run_with(good_mesh_, {"--only", "two"}), 0);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two", "two"}));
}

TEST_F(BenchTest, KeepKeepsTheMesh) {
  EXPECT_EQ(run_with(good_mesh_, {"--only", "one", "--keep"}), 0);
  bool is_kept = false;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "results"))
    is_kept = is_kept || entry.path().filename() == "mesh.vtu";
  EXPECT_TRUE(is_kept);
}

TEST_F(BenchTest, FailedTrialIsRecordedTheOthersStillRunAndTheExitCodeTells) {
  EXPECT_EQ(run_with("case $* in *--radius*) exit 3;; esac\n"), 1);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(files_in_results(), 1u);
}

TEST_F(BenchTest, InterruptEndsTheTrialRecordsItAndStops) {
  EXPECT_EQ(run_with("kill -INT $PPID; sleep 30"), 1);  // what Ctrl-C sends to podm-bench
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one"}));
  EXPECT_NE(printed("out").find("interrupted"), std::string::npos);
  EXPECT_EQ(files_in_results(), 1u);
}

TEST_F(BenchTest, BadUsageAndInputExitWithTwoAndRecordNothing) {
  const std::string path = folder_ / "exp.toml";
  EXPECT_EQ(bench({}), 2);
  EXPECT_EQ(bench({"fly"}), 2);
  EXPECT_EQ(bench({"run"}), 2);
  EXPECT_EQ(bench({"run", path, "--colour"}), 2);
  EXPECT_EQ(bench({"run", folder_ / "absent.toml"}), 2);
  EXPECT_EQ(run_with(good_mesh_, {"--only", "four"}), 2);
  EXPECT_NE(printed("err").find("four"), std::string::npos);
  folder_.write("exp.toml", "colour = 1\n" + kExperiment);
  EXPECT_EQ(run_with(good_mesh_), 2);
  EXPECT_NE(printed("err").find(path + ":1:1:"), std::string::npos) << printed("err");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

TEST_F(BenchTest, ListShowsTitleAndTime) {
  EXPECT_EQ(bench({"list", folder_.path()}), 0);
  EXPECT_NE(printed("out").find("Some title"), std::string::npos);
  EXPECT_EQ(bench({"list", folder_ / "absent"}), 2);
}

}  // namespace
}  // namespace podm::bench
