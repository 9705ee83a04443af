// Tests of the rows that may be judged.
#include "rows/row_filter.h"

#include <gtest/gtest.h>

#include "rows/machine_state.h"
#include "tests/synthetic_rows.h"

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
  ask(peer, "mesher", "other");
  peer.programs.peer = {"other", "its own", "1.0"};
  ask(machine, "measure", "memory_latency");
  EXPECT_EQ(keys({peer, machine, row("a", "1"), row("b", "2")}), "pmb") << "they are not of podm's build";
  Row on_ranks = row("r", "1"), earlier = row("s", "1");
  ask(on_ranks, "ranks", 2);
  ask(earlier, "ranks", 2);
  on_ranks.programs.podm_mpi.emplace().sha256 = "new";
  earlier.programs.podm_mpi.emplace().sha256 = "old";
  EXPECT_EQ(keys({earlier, on_ranks, row("a", "2")}), "ra") << "podm-mpi is a program of its own";
  Row changed = row("a", "1");  // as after a failed preparation
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

Row simulated(const std::string& trial, const std::string& cpu, const std::string& model = "m") {
  Row row = refined_in(1, {{"executor", "virtual"}, {"topology", "machine.toml"}}, 1, trial);
  row.environment.cpu = cpu;
  mesh_of(row).virtual_time.emplace().as_written =
      std::make_shared<const Json>(Json{{"machine", {{"sha256", model}}}});
  return row;
}

std::string trials_of(const Rows& rows) {
  std::string text;
  for (const Row& row : rows) text += row.trial;
  return text;
}

TEST(RowsToJudge, SimulatedOnesCountWhereverTheyWereMade) {
  Row measured = refined_in(1, {}, 1, "m");
  EXPECT_EQ(trials_of(rows_to_judge({simulated("a", "one"), measured, simulated("b", "other")})), "amb")
      << "a simulated row names no machine, so that the measured one stays";
  EXPECT_EQ(trials_of(rows_to_judge({simulated("a", "one", "old"), simulated("b", "one", "new")})), "b")
      << "two versions of a description are two machines";
  Row other_program = simulated("a", "one");
  other_program.programs.podm.sha256 = "old";
  EXPECT_EQ(trials_of(rows_to_judge({other_program, simulated("b", "one")})), "b");
  Row nodes = refined_in(1, {{"executor", "virtual"}}, 1, "n");
  nodes.environment.numa_nodes = std::uint64_t{4};
  Row more_nodes = nodes;
  more_nodes.trial = "o";
  more_nodes.environment.numa_nodes = std::uint64_t{8};
  EXPECT_EQ(trials_of(rows_to_judge({nodes, more_nodes})), "o")
      << "virtual workers are spread over the nodes";
}

TEST(RowsToJudge, RowsOfOtherMachinesAreLeftOutAndNamed) {
  Row here = refined_in(1, {}, 1, "h"), elsewhere = refined_in(1, {}, 1, "e");
  here.environment.identity.emplace().model = 17UL;
  elsewhere.environment.identity.emplace().model = 2UL;
  const Rows rows{elsewhere, elsewhere, here, simulated("s", "third")};
  EXPECT_EQ(trials_of(rows_to_judge(rows)), "hs");
  EXPECT_EQ(trials_of(rows_of_other_machines(rows)), "ee");
  const std::string text = describe_left_out(rows_of_other_machines(rows));
  EXPECT_NE(text.find("2 of some (" + std::string(" family 0 model 2 ")), std::string::npos) << text;
  EXPECT_EQ(describe_left_out(rows_of_other_machines({here})), "");
  EXPECT_TRUE(rows_of_other_machines({}).empty());
}

TEST(RowOptions, HaveTheirDefaultsAndTheImage) {
  const Json options = options_of(synthetic_row("1M", {{"contention", "local"}}));
  EXPECT_EQ(option(options, "mesher"), "podm");
  EXPECT_EQ(option(options, "executor"), "threads");
  EXPECT_EQ(option(options, "contention"), "local");
  EXPECT_EQ(option(options, "input"), "image");
  EXPECT_EQ(option(options, "seed"), kNoOption);
}

}  // namespace
}  // namespace podm::bench
