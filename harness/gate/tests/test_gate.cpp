// Tests of the gate's tiers and of its file of budgets.
#include "gate/gate.h"

#include <gtest/gtest.h>

#include "errors.h"
#include "gate/gate_budget.h"
#include "rows/codec.h"
#include "tests/fake_mesher.h"

namespace podm::bench {
namespace {

TEST(Work, DifferencesNameEachValueThatChangedCameOrWent) {
  const auto committed = from_json<Work>({{"cells", 10}, {"insertions", {{"R1", 3}, {"R2", 4}}}});
  EXPECT_TRUE(differences(committed, committed).empty());
  const auto measured = from_json<Work>({{"cells", 10}, {"insertions", {{"R1", 5}, {"R3", 6}}}});
  EXPECT_EQ(differences(committed, measured),
            (std::vector<std::string>{"insertions/R1: 5, committed 3", "insertions/R2: null, committed 4",
                                      "insertions/R3: 6, committed null"}));
}

// A mesher that proves its mesh and does the work {"cells":1000,...}; `tail` is the end of its record.
class GateTest : public testing::Test {
 protected:
  GateTest() {
    folder_.write("budgets.json", R"({"schema":1,"build":"","instructions_tolerance":0.5,
      "timed":{"name":"t","image":"phantom:torus","radius_mm":3},
      "budgets":[{"name":"one","image":"phantom:torus","radius_mm":3,"instructions":1,"work":{}}]})");
  }
  GateOptions options(const std::string& mesher, std::vector<int> tiers) {
    return {.head = mesher, .base = {}, .budgets_path = folder_ / "budgets.json", .tiers = std::move(tiers)};
  }
  std::string mesher(const std::string& tail, const std::string& body = "") {
    std::string record = kGoodRecord;
    record.back() = ',';
    return fake_mesher(folder_, body + "echo '" + record + tail + "}' > \"$record\"\n");
  }
  const std::string proved_ = R"("verdicts":{"size":"pass"},"counters":{"conflict_tests":5})";
  TemporaryFolder folder_;
};

TEST_F(GateTest, WorkAsCommittedPassesAndAnyOtherBlocks) {
  renew_budgets(options(mesher(proved_), {}), {});
  EXPECT_EQ(read_budgets(folder_ / "budgets.json").budgets.at(0).work.conflict_tests, 5u);
  EXPECT_TRUE(gate(options(mesher(proved_), {1}), {}));
  EXPECT_FALSE(
      gate(options(mesher(R"("verdicts":{"size":"pass"},"counters":{"conflict_tests":6})"), {1}), {}));
}

TEST_F(GateTest, UnprovedMeshBlocksAndIsNoBudget) {
  renew_budgets(options(mesher(proved_), {}), {});
  for (const char* verdicts : {R"({"size":"fail"})", R"({"size":"not_run"})", "{}"}) {
    const std::string unproved =
        mesher(std::string(R"("counters":{"conflict_tests":5},"verdicts":)") + verdicts);
    EXPECT_FALSE(gate(options(unproved, {1}), {})) << verdicts;
    EXPECT_THROW(renew_budgets(options(unproved, {}), {}), InputError) << verdicts;
  }
  EXPECT_FALSE(gate(options(mesher(proved_, "exit 3\n"), {1}), {}));
}

TEST_F(GateTest, MoreInstructionsThanTheBudgetAllowsBlock) {
  renew_budgets(options(mesher(proved_), {}), {});
  EXPECT_FALSE(gate(options(mesher(proved_, "i=0; while [ $i -lt 20000 ]; do i=$((i+1)); done\n"), {1}), {}));
}

TEST_F(GateTest, SlowerHeadBlocksAndFasterOneDoesNot) {
  const std::string slow = folder_ / "slow";
  std::filesystem::copy_file(mesher(proved_, "i=0; while [ $i -lt 30000 ]; do i=$((i+1)); done\n"), slow);
  GateOptions both = options(mesher(proved_), {2});
  both.base = slow;
  EXPECT_TRUE(gate(both, {}));
  std::swap(both.base, both.head);
  EXPECT_FALSE(gate(both, {}));
}

TEST_F(GateTest, FailureIsNoAnswer) {
  GateOptions both = options(mesher(proved_), {2});
  both.base = folder_.script("broken", "exit 3\n");
  EXPECT_THROW(gate(both, {}), InputError);
  EXPECT_THROW(gate(options(folder_ / "absent", {1}), {}), InputError);
  EXPECT_THROW(gate(options(mesher(proved_), {1}), [] { return true; }), InputError) << "stopped by the user";
}

TEST_F(GateTest, BrokenBudgetsAreRefusedByName) {
  for (const char* text : {"", "[]", "{", R"({"schema":2})", R"({"schema":1,"build":""})"}) {
    const std::string path = folder_.write("budgets.json", text);
    try {
      read_budgets(path);
      ADD_FAILURE() << text;
    } catch (const InputError& fault) {
      EXPECT_NE(std::string(fault.what()).find(path), std::string::npos) << fault.what();
    }
  }
  EXPECT_THROW(read_budgets(folder_ / "absent.json"), InputError);
}

TEST_F(GateTest, BudgetsAreReadAsWritten) {
  const Budgets written = read_budgets(folder_ / "budgets.json");
  write_budgets(written, folder_ / "again.json");
  const Budgets read = read_budgets(folder_ / "again.json");
  EXPECT_EQ(read.timed.image, written.timed.image);
  EXPECT_EQ(read.instructions_tolerance, written.instructions_tolerance);
  ASSERT_EQ(read.budgets.size(), 1u);
  EXPECT_EQ(read.budgets[0].trial.radius_mm, 3);
  EXPECT_EQ(read.budgets[0].instructions, 1u);
}

}  // namespace
}  // namespace podm::bench
