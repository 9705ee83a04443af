// Tests of several processes of one trial at the same time.
#include <gtest/gtest.h>

#include "machine/machine.h"
#include "options/option_keys.h"
#include "process/usable_processors.h"
#include "rows/codec.h"
#include "tests/fake_mesher.h"
#include "trials/trial.h"

namespace podm::bench {
namespace {

class SideBySideTest : public testing::Test {
 protected:
  void SetUp() override {
    if (usable_processors() < 2) GTEST_SKIP() << "skipped: one processor";
  }
  // $copy is empty in the first copy, otherwise the number of the copy.
  TrialResult run(const std::string& mesh_body) {
    Trial trial;
    trial.name = "some";
    trial.image = "image.nii";
    trial.options = {{"threads", 1}, {kCopies, 2}};
    trial.timeout_s = 20;
    const std::string body = "copy=; case $record in */copy2/*) copy=2;; esac\n" + mesh_body;
    return TrialRunner({fake_mesher(folder_, body), {}}).run(trial, prepared(trial), folder_.path());
  }
  // A good record whose hash of the mesh is `hash`, a text for the shell.
  static std::string record(const std::string& hash) {
    std::string text = kGoodRecord;
    text.insert(1, R"("mesh_sha256":"')" + hash + R"('",)");
    return "echo '" + text + "' > \"$record\"\n";
  }
  TemporaryFolder folder_;
};

// Each copy waits for the other's file. Copies that run one after the other would never end.
TEST_F(SideBySideTest, CopiesRunAtTheSameTimeAndTheRowsOwnIsTheFirsts) {
  const TrialResult result = run(R"(
mine=$(dirname "$0")/is$copy other=$(dirname "$0")/is$([ "$copy" ] || echo 2)
: > "$mine"; until [ -e "$other" ]; do sleep 0.01; done
)" + record("same"));
  EXPECT_EQ(result.status, Status::kOk) << result.reason;
  ASSERT_EQ(result.side_by_side.value().size(), 2u);
  EXPECT_EQ(result.mesh.value().cells, 1000u);
  for (const CopyRecord& copy : *result.side_by_side) {
    EXPECT_EQ(copy.cells, 1000u);
    EXPECT_EQ(copy.refine_cells_per_second, 1000.0);
    EXPECT_EQ(*copy.phases_s.find("refine"), 1.0);
  }
  EXPECT_EQ(result.command.back(), "--quiet");
}

TEST_F(SideBySideTest, EachHasAProcessorOfItsOwn) {
  const TrialResult result =
      run("taskset -cp $$ | sed 's/.*: //' > \"$(dirname \"$0\")/processors$copy\"\n" + record("same"));
  ASSERT_TRUE(result.side_by_side) << result.reason;
  const std::vector<CopyRecord>& copies = *result.side_by_side;
  ASSERT_EQ(copies.size(), 2u);
  for (const int i : {0, 1})
    EXPECT_EQ(read_tail(folder_ / (i == 0 ? "processors" : "processors2"), 100),
              std::to_string(copies[static_cast<std::size_t>(i)].processor) + "\n");
  EXPECT_NE(copies[0].processor, copies[1].processor);
}

TEST_F(SideBySideTest, FaultOfAnyIsTheTrials) {
  const TrialResult failed = run(record("same") + "[ -z \"$copy\" ] || exit 3\n");
  EXPECT_EQ(failed.status, Status::kFailed);
  EXPECT_EQ(failed.reason, "copy 2: exit code 3");
  EXPECT_FALSE(failed.side_by_side);
  const TrialResult first_failed = run(record("same") + "[ \"$copy\" ] || exit 3\n");
  EXPECT_EQ(first_failed.status, Status::kFailed);
  EXPECT_EQ(first_failed.reason, "exit code 3");
  const TrialResult differs = run(record("of$copy"));
  EXPECT_EQ(differs.status, Status::kUnmet);
  EXPECT_EQ(differs.reason, "copy 2: another mesh");
}

TEST_F(SideBySideTest, CountersOfTheKernelAreNotMixedUp) {
  const Json counters = to_json(run(record("same")).counters);
  ASSERT_EQ(counters.size(), 1u);
  EXPECT_TRUE(counters["perf_event"].get<std::string>().starts_with("unavailable: "));
}

}  // namespace
}  // namespace podm::bench
