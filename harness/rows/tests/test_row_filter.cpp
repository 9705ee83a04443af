// Which rows may be judged at all.
#include "rows/row_filter.h"

#include <gtest/gtest.h>

#include "tests/made_up_rows.h"

namespace podm::bench {
namespace {

using Rows = std::vector<Row>;

TEST(RowsToJudge, AreTheNewestOfEachKeyOfOneBuildAndMachine) {
  const auto row = [](const std::string& key, const std::string& build, const std::string& cpu = "some") {
    Row made = refined_in(1, {});
    made.key = made.trial = key;
    made.programs.podm.sha256 = build;
    made.environment.cpu = cpu;
    return made;
  };
  const auto keys = [](const Rows& rows) {
    std::string text;
    for (const Row& judged : rows_to_judge(rows)) text += judged.key;
    return text;
  };
  EXPECT_EQ(keys({row("a", "1"), row("b", "2"), row("c", "2")}), "bc");
  EXPECT_EQ(keys({row("a", "1"), row("b", "1", "other"), row("c", "1")}), "ac");
  Rows again{row("a", "1"), row("b", "1"), row("a", "1")};
  again[2].status = Status::kUnmet;
  ASSERT_EQ(keys(again), "ab");
  EXPECT_EQ(rows_to_judge(again)[0].status, Status::kUnmet);
  again[2].status = Status::kInterrupted;
  EXPECT_EQ(rows_to_judge(again)[0].status, Status::kOk) << "what the user ended says nothing";
  again[1].warmup = true;
  EXPECT_EQ(keys(again), "a");
  Row peer = row("p", "1"), machine = row("m", "1");
  peer.asked["mesher"] = "other";
  peer.programs.peer = {"other", "its own", "1.0"};
  machine.asked["measure"] = "memory_latency";
  EXPECT_EQ(keys({peer, machine, row("a", "1"), row("b", "2")}), "pmb") << "they are not of podm's build";
  Row on_ranks = row("r", "1"), earlier = row("s", "1");
  on_ranks.asked["ranks"] = earlier.asked["ranks"] = 2;
  on_ranks.programs.podm_mpi.emplace().sha256 = "new";
  earlier.programs.podm_mpi.emplace().sha256 = "old";
  EXPECT_EQ(keys({earlier, on_ranks, row("a", "2")}), "ra") << "podm-mpi is a program of its own";
  Row changed = row("a", "1");  // as after a preparation that failed
  changed.key = "another";
  EXPECT_EQ(keys({row("a", "1"), changed}), "another");
  EXPECT_EQ(keys({changed, row("a", "1")}), "a");
  changed.repeat = 2;
  EXPECT_EQ(keys({row("a", "1"), changed}), "aanother");
  changed.repeat = 1;
  changed.input.name = "other image";
  EXPECT_EQ(keys({row("a", "1"), changed}), "aanother");
  EXPECT_EQ(keys({}), "");
}

TEST(RowOptions, HaveTheirDefaultsAndTheImage) {
  const Json options = options_of(made_up_row("1M", {{"contention", "local"}}));
  EXPECT_EQ(option(options, "mesher"), "podm");
  EXPECT_EQ(option(options, "executor"), "threads");
  EXPECT_EQ(option(options, "contention"), "local");
  EXPECT_EQ(option(options, "input"), "image");
  EXPECT_EQ(option(options, "seed"), kNoOption);
}

}  // namespace
}  // namespace podm::bench
