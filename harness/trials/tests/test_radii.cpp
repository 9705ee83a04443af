// Tests of trials with a target number of cells, as a user runs them.
#include "tests/bench_test.h"

namespace podm::bench {
namespace {

class TargetTest : public BenchTest {
 protected:
  TargetTest() {
    std::string text = kExperiment;
    text.replace(text.find("radius_mm = 2"), 13, "target_elements = 1000\nthreads = [1, 2]");
    folder_.write("exp.toml", text);
  }
  // The radius found is read from the file "radius".
  const std::string finds_radius_ = R"script(cd "$(dirname "$0")"
case $(cat arguments) in *--target*)
  echo x >> found
  echo "{\"stop_reason\":\"complete\",\"cells\":990,\"used\":{\"radius_mm\":$(cat radius),\"delta_mm\":1}}" > "$record"
  exit;;
esac
)script" + good_mesh_;
};

TEST_F(TargetTest, RadiusIsFoundOnceForAllTrialsAndStored) {
  folder_.write("radius", "2.25");
  EXPECT_EQ(run_with(finds_radius_), 0) << printed("err");
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two,threads=1", "two,threads=2"}));
  for (const auto& row : rows()) {
    const bool has_target = row.at("trial") != "one";
    EXPECT_EQ(row.at("resolved").is_null(), !has_target);
    const auto command = row.at("command").dump();
    EXPECT_EQ(command.find("\"--radius\",\"2.25\",\"--delta\",\"1\"") != std::string::npos, has_target)
        << command;
    EXPECT_EQ(command.find("target"), std::string::npos) << command;
    EXPECT_EQ(row.at("asked").contains("target_elements"), has_target);
    EXPECT_EQ(row.at("input").at("name"), "phantom:torus");
    EXPECT_EQ(row.at("command")[2], folder_ / "results/inputs/torus.nii.gz");
  }
  EXPECT_EQ(printed("found"), "x\n");
  EXPECT_TRUE(has_printed("err", "finding the radius of 1000 cells")) << printed("err");
  EXPECT_EQ(run_with(finds_radius_), 0);
  EXPECT_EQ(rows().size(), 3u) << "resumed";
  EXPECT_EQ(printed("found"), "x\n");
}

TEST_F(TargetTest, RowsOfAnotherRadiusDoNotCount) {
  folder_.write("radius", "2.25");
  run_with(finds_radius_);
  std::filesystem::remove(folder_ / "results/radii.jsonl");
  EXPECT_EQ(run_with(finds_radius_), 0);
  EXPECT_EQ(rows().size(), 3u) << "the same radius is found again";
  EXPECT_TRUE(has_printed("err", "already measured")) << printed("err");
  std::filesystem::remove(folder_ / "results/radii.jsonl");
  folder_.write("radius", "2.5");
  EXPECT_EQ(run_with(finds_radius_), 0);
  EXPECT_EQ(rows().size(), 5u);
}

TEST_F(TargetTest, RadiusThatIsNotFoundIsAFailedRowAndTheRunGoesOn) {
  EXPECT_EQ(
      run_with("case $(cat $(dirname $0)/arguments) in *--target*) echo 'too large' >&2; exit 2;; esac\n" +
               good_mesh_),
      1);
  EXPECT_EQ(trials_recorded(), (std::vector<std::string>{"one", "two,threads=1", "two,threads=2"}));
  for (const auto& row : rows()) {
    if (row.at("trial") == "one") continue;
    EXPECT_EQ(row.at("status"), "failed");
    EXPECT_EQ(row.at("reason"), "no radius for 1000 cells: exit code 2");
    EXPECT_EQ(row.at("stderr_tail"), "too large\n");
    EXPECT_NE(row.at("command").dump().find("--target-elements"), std::string::npos);
  }
}

TEST_F(TargetTest, InterruptWhileFindingTheRadiusIsARowAndStops) {
  EXPECT_EQ(run_with("kill -INT $PPID; sleep 30", {"--only", "two*"}), 1);
  ASSERT_EQ(rows().size(), 1u);
  EXPECT_EQ(rows()[0].at("status"), "interrupted");
  EXPECT_NE(rows()[0].at("reason").get<std::string>().find("no radius"), std::string::npos);
  EXPECT_TRUE(is_tidy());
}

TEST_F(TargetTest, DryRunFindsNothingButUsesWhatIsStored) {
  folder_.write("radius", "2.25");
  EXPECT_EQ(run_with(finds_radius_, {"--dry-run"}), 0);
  EXPECT_TRUE(has_printed("out", "--target-elements 1000")) << printed("out");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "found"));
  run_with(finds_radius_, {"--only", "two,threads=1"});
  EXPECT_EQ(run_with(finds_radius_, {"--dry-run"}), 0);
  EXPECT_TRUE(has_printed("out", "--threads 2 --radius 2.25 --delta 1")) << printed("out");
  EXPECT_TRUE(has_printed("out", "4 runs, 3 to do")) << printed("out");
}

}  // namespace
}  // namespace podm::bench
