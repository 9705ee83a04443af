// Tests of podm-bench verdicts, and of the verdicts that a run prints.
#include "experiments/verdicts.h"

#include <gtest/gtest.h>

#include "rows/results_file.h"
#include "tests/bench_test.h"
#include "tests/synthetic_rows.h"

namespace podm::bench {
namespace {

const std::string kExperimentWithClaims = experiment_of(6, "phantom:torus", R"(threads = [1, 2]
[[claims]]
name = "fast"
statement = "It is fast."
note = "The reason is known."
basis = "measured"
kind = "bound"
value = "refining_seconds"
at_most = 2
[[claims]]
name = "sound"
statement = "It is sound."
basis = "any"
kind = "share"
value = "passed"
at_least = 1.0
[[claims]]
name = "near"
statement = "It reads nearby."
basis = "simulated"
kind = "bound"
value = "zero_hop_share"
at_least = 0.9
supersedes = ["nearer"]
reason = "The word was too strong."
[[withdrawn]]
name = "cheap"
statement = "It is cheap."
reason = "It was refuted."
)");

// Other work kept half of the processors busy during the measurement of this row.
Row disturbed(Row row) {
  row.environment.busy_elsewhere = 0.5 * row.environment.usable_processors;
  return row;
}

class VerdictsTest : public BenchTest {
 protected:
  VerdictsTest() : path_(folder_.write("exp.toml", kExperimentWithClaims)) {
    std::filesystem::create_directory(folder_ / "results");
  }
  int verdicts(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"verdicts", "--results", folder_ / "results", path_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench(arguments);
  }
  // Six rounds on 1, 2, ... threads.
  void write_rows(const std::vector<double>& seconds) {
    std::vector<Row> rows;
    for (const double s : seconds) {
      const std::size_t threads = rows.size() + 1;
      rows.push_back(refined_in(s, {{"threads", threads}}, 1, "some,threads=" + std::to_string(threads)));
    }
    std::string lines;
    for (const Row& row : in_six_rounds(rows)) lines += as_line(row);
    folder_.write("results/exp.jsonl", lines);
  }
  std::string path_;
};

TEST_F(VerdictsTest, ArePrintedForEachClaimAndNeverChangeTheExitCode) {
  write_rows({1, 5});
  EXPECT_EQ(verdicts(), 0) << printed("err");
  for (const char* words :
       {"DOES NOT HOLD      exp         fast", "holds              exp         sound", "cannot be decided",
        "at most 2", "threads=2: 5 s", "5 to 5, 96.9 %", "It is fast. The reason is known.",
        "Claims: 1 hold, 1 do not hold, 0 not resolved, 1 cannot be decided here; 2 withdrawn or "
        "superseded",
        "withdrawn          exp         cheap", "It was refuted.",
        "superseded by near: The word was too strong."})
    EXPECT_TRUE(has_printed("out", words)) << words << "\n" << printed("out");
  EXPECT_FALSE(has_printed("out", "It is sound.")) << "what holds needs no words";
}

TEST_F(VerdictsTest, WorkWithoutAnyRows) {
  EXPECT_EQ(verdicts(), 0);
  EXPECT_TRUE(has_printed("out", "Claims: 0 hold, 0 do not hold, 0 not resolved, 3 cannot be decided here"));
  EXPECT_EQ(bench({"verdicts", "--results", folder_ / "absent", path_}), 0);
}

TEST_F(VerdictsTest, RefuseAClaimOfTwoExperiments) {
  const std::string other = folder_.write("other.toml", kExperimentWithClaims);
  EXPECT_EQ(verdicts({other}), 2);
  EXPECT_NE(printed("err").find("other.toml:12:"), std::string::npos) << printed("err");
  EXPECT_NE(printed("err").find("a second claim 'fast'; the first is in "), std::string::npos);
  EXPECT_NE(printed("err").find("exp.toml:12:"), std::string::npos);
  EXPECT_EQ(bench({"list", folder_ / "."}), 2);
  EXPECT_EQ(bench({"run", "--dry-run", path_, other}), 2);
}

TEST_F(VerdictsTest, RefuseBadInput) {
  EXPECT_EQ(bench({"verdicts", folder_ / "absent.toml"}), 2);
  folder_.write("results/exp.jsonl", "{\"schema\":99}\n");
  EXPECT_EQ(verdicts(), 2);
  EXPECT_NE(printed("err").find("exp.jsonl:1:"), std::string::npos);
}

TEST_F(VerdictsTest, AreWrittenAsJson) {
  write_rows({1, 5});
  EXPECT_EQ(verdicts({"--json", folder_ / "verdicts.json"}), 0);
  std::ifstream file(folder_ / "verdicts.json");
  const Json json = Json::parse(file, nullptr, false);
  EXPECT_EQ(json["schema"], "podm-bench-verdicts/2");
  ASSERT_EQ(json["experiments"].size(), 1u);
  const Json& experiment = json["experiments"][0];
  EXPECT_EQ(experiment["experiment"], "exp");
  EXPECT_EQ(experiment["title"], "Title");
  EXPECT_EQ(experiment["claim"], "Headline");
  EXPECT_EQ(experiment["paper"], "Table 7");
  ASSERT_EQ(experiment["claims"].size(), 3u);
  const std::string reason =
      "1 of 2 hold; threads=2: 5 s, 5 to 5 holds the median with 96.9 % (6 rounds). The reason is known.";
  EXPECT_EQ(experiment["claims"][0],
            (Json{{"name", "fast"},
                  {"statement", "It is fast."},
                  {"basis", "measured"},
                  {"verdict", "does_not_hold"},
                  {"reason", reason},
                  {"value", 5.0},
                  {"interval", {{"low", 5.0}, {"high", 5.0}, {"coverage", 0.96875}, {"rounds", 6}}},
                  {"rounds_needed", nullptr},
                  {"bound", "at most 2"},
                  {"sizes", Json::array()},
                  {"n", 12}}));
  EXPECT_EQ(experiment["withdrawn"], (Json{{{"name", "cheap"},
                                            {"statement", "It is cheap."},
                                            {"verdict", "withdrawn"},
                                            {"reason", "It was refuted."},
                                            {"superseded_by", nullptr}},
                                           {{"name", "nearer"},
                                            {"statement", ""},
                                            {"verdict", "withdrawn"},
                                            {"reason", "The word was too strong."},
                                            {"superseded_by", "near"}}}));
  EXPECT_EQ(experiment["claims"][2]["verdict"], "cannot_be_decided");
  EXPECT_TRUE(experiment["claims"][2]["value"].is_null());
  EXPECT_EQ(experiment["claims"][2]["reason"], "no rows");
}

TEST_F(VerdictsTest, SayOnTopThatTheMachineWasBusyAndWhichRowsAreLeftOut) {
  const auto row = [](const std::string& cpu, int threads) {
    Row made = refined_in(1, {{"threads", threads}}, 1, "some,threads=" + std::to_string(threads));
    made.environment.cpu = cpu;
    return made;
  };
  folder_.write("results/exp.jsonl",
                as_line(row("first", 1)) + as_line(row("other", 1)) + as_line(disturbed(row("other", 2))));
  EXPECT_EQ(verdicts({"--json", folder_ / "verdicts.json"}), 0) << printed("err");
  const std::string busy =
      "Other work kept 8.0 of 16 processors busy during 1 of 2 runs: measured claims are not resolved.";
  EXPECT_EQ(printed("out").find("exp: " + busy), 0u) << printed("out");
  EXPECT_TRUE(has_printed("out", "left out: 1 of first")) << printed("out");
  std::ifstream file(folder_ / "verdicts.json");
  const Json experiment = Json::parse(file)["experiments"][0];
  EXPECT_EQ(experiment["measured"], 2);
  EXPECT_EQ(experiment["disturbed"], 1);
  EXPECT_EQ(experiment["probe_moved"], 0);
  ASSERT_EQ(experiment["remarks"].size(), 2u);
  EXPECT_EQ(experiment["remarks"][0], busy);
}

TEST_F(VerdictsTest, RowsOfTrialsThatTheExperimentNoLongerHasDoNotCount) {
  write_rows({1, 1});
  std::string renamed = kExperimentWithClaims;
  renamed.replace(renamed.find("\"some\""), 6, "\"other\"");
  folder_.write("exp.toml", renamed);
  EXPECT_EQ(verdicts(), 0);
  EXPECT_TRUE(has_printed("out", "3 cannot be decided here"));
}

TEST_F(VerdictsTest, ARunPrintsThemAndOnlyAFailedTrialChangesItsExitCode) {
  const auto make = [](const std::string& record) { return "echo '" + record + "' > \"$record\"\n"; };
  // Cells of one thread are the same in each run, on a busy machine too.
  std::string of_cells = kExperimentWithClaims;
  of_cells.replace(of_cells.find("refining_seconds\"\nat_most = 2"), 29, "cells\"\nat_most = 2000");
  of_cells.replace(of_cells.find("[1, 2]"), 6, "1");
  folder_.write("exp.toml", of_cells);
  std::string slow = kGoodRecord;
  slow.replace(slow.find("\"cells\":1000"), 12, "\"cells\":3000");
  EXPECT_EQ(run_with(make(slow)), 0) << printed("err");
  EXPECT_TRUE(has_printed("out", "DOES NOT HOLD      exp         fast"));
  EXPECT_TRUE(has_printed("out", "Claims: 1 hold, 1 do not hold, 0 not resolved"));
  EXPECT_EQ(run_with(make(kGoodRecord)), 0);
  EXPECT_TRUE(has_printed("out", "Claims: 2 hold, 0 do not hold")) << printed("out");
  std::string unmet = kGoodRecord;
  unmet.replace(unmet.find("\"radius_edge\":0"), 15, "\"radius_edge\":1");
  EXPECT_EQ(run_with(make(unmet)), 1);
  EXPECT_TRUE(has_printed("out", "0 of 6, not some"));
}

}  // namespace
}  // namespace podm::bench
