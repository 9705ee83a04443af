// Runs podm-bench as a user does, with a mesher that the test writes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "process/process.h"
#include "tests/fake_mesher.h"

namespace podm::bench {

inline const std::string kExperiment = R"(title = "Some title"
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
)" + kClaim;

class BenchTest : public testing::Test {
 protected:
  BenchTest() { folder_.write("exp.toml", kExperiment); }

  // Returns the exit code of podm-bench. Its output is in the files "out" and "err".
  int bench(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), PODM_BENCH);
    const ProcessOutcome outcome = run_process({.arguments = arguments,
                                                .stdout_path = folder_ / "out",
                                                .stderr_path = folder_ / "err",
                                                .timeout_s = 240});
    EXPECT_EQ(outcome.end, ProcessOutcome::End::kExited) << outcome.describe() << "\n" << printed("err");
    return outcome.exit_code;
  }
  int run_with(const std::string& mesh_body, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{
        "run",       folder_ / "exp.toml", "--podm",     fake_mesher(folder_, mesh_body),
        "--results", folder_ / "results",  "--verifier", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench(arguments);
  }
  std::string printed(const std::string& name) { return read_tail(folder_ / name, 10000); }
  bool has_printed(const std::string& name, const std::string& words) {
    return printed(name).find(words) != std::string::npos;
  }
  std::vector<nlohmann::json> rows() {
    std::ifstream file(folder_ / "results/exp.jsonl");
    std::vector<nlohmann::json> rows;
    for (std::string line; std::getline(file, line);) rows.push_back(nlohmann::json::parse(line));
    return rows;
  }
  // Returns names in the order in which the trials ran.
  std::vector<std::string> in_order() {
    std::vector<std::string> trials;
    for (const auto& row : rows()) trials.push_back(row.at("trial"));
    return trials;
  }
  std::vector<std::string> trials_recorded() {
    std::vector<std::string> trials = in_order();
    std::sort(trials.begin(), trials.end());
    return trials;
  }
  // True if only rows, logs, inputs, lock and topology are left.
  bool is_tidy() {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "results")) {
      const std::string name = entry.path().filename();
      if (name != "exp.jsonl" && name != "inputs" && name != ".lock" && name != "logs" &&
          !name.starts_with("topology-"))
        return false;
    }
    return true;
  }
  const std::string good_mesh_ = "echo mesh > \"$output\"; echo '" + kGoodRecord + "' > \"$record\"\n";
  TemporaryFolder folder_;
};

}  // namespace podm::bench
