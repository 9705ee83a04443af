// Tests of rows of the same machine, and of rows of a busy or unsteady one.
#include "rows/machine_state.h"

#include <gtest/gtest.h>

#include <set>

#include "rows/series.h"
#include "tests/synthetic_rows.h"

namespace podm::bench {
namespace {

IdentityRecord some_identity() {
  return {.vendor = "AuthenticAMD",
          .family = 25UL,
          .model = 17UL,
          .stepping = 1UL,
          .cache_bytes = ByName<std::uint64_t>{{"L1", 32768}, {"L2", 1048576}},
          .memory_gib = 24UL,
          .kernel = "Linux 6"};
}

Row identified(const IdentityRecord& identity = some_identity()) {
  Row row = refined_in(1, {});
  row.environment.identity = identity;
  row.environment.topology_sha256 = "aaaaaaaaaaaa";
  return row;
}

TEST(SameMachine, EachPartOfTheIdentityMatters) {
  std::vector<IdentityRecord> others(7, some_identity());
  others[0].vendor = "GenuineIntel";
  others[1].family = 26UL;
  others[2].model = 2UL;
  others[3].stepping = Unavailable{"no such line"};
  others[4].cache_bytes = ByName<std::uint64_t>{{"L1", 32768}, {"L2", 524288}};
  others[5].memory_gib = 48UL;
  others[6].kernel = "Linux 7";
  std::set<std::string> names{machine_name(identified())};
  for (const IdentityRecord& other : others) {
    EXPECT_FALSE(same_machine(identified(), identified(other)));
    EXPECT_TRUE(same_machine(identified(other), identified(other)));
    names.insert(machine_name(identified(other)));
  }
  EXPECT_EQ(names.size(), 8u) << "a name states what differs";
}

TEST(SameMachine, StateIsNoPartOfIt) {
  Row later = identified();
  later.environment.topology_sha256 = "bbbbbbbbbbbb";  // memory that the host took back
  later.environment.probe = ProbeRecord{1, 2, 3};
  later.environment.busy_elsewhere = 1.0;
  later.environment.load_average = std::vector<double>{9, 9, 9};
  EXPECT_TRUE(same_machine(identified(), later));
}

TEST(SameMachine, RowsWithoutIdentityAreDistinguishedByTheirTopology) {
  Row old = identified(), other = identified();
  old.environment.identity.reset();
  EXPECT_FALSE(same_machine(old, other));
  other.environment.identity.reset();
  EXPECT_TRUE(same_machine(old, other));
  other.environment.topology_sha256 = "bbbbbbbbbbbb";
  EXPECT_FALSE(same_machine(old, other));
  EXPECT_NE(machine_name(old), machine_name(other));
}

TEST(Disturbed, IsMoreThanATenthOfEachUsableProcessor) {
  Row row = identified();
  row.environment.usable_processors = 4;
  EXPECT_FALSE(is_disturbed(row)) << "unknown";
  for (const auto& [busy, expected] : {std::pair{0.0, false}, {0.4, false}, {0.41, true}, {4.0, true}}) {
    row.environment.busy_elsewhere = busy;
    EXPECT_EQ(is_disturbed(row), expected) << busy;
  }
  row.basis = Basis::kSimulated;
  EXPECT_FALSE(is_disturbed(row));
  row.basis = Basis::kMeasured;
  row.environment.busy_elsewhere = Unavailable{"why"};
  EXPECT_FALSE(is_disturbed(row));
}

TEST(MachineState, IsDescribedInSentences) {
  std::vector<Row> rows(5, identified());
  EXPECT_TRUE(machine_state(rows).remarks().empty());
  for (Row& row : rows) row.environment.usable_processors = 2;
  rows[0].environment.busy_elsewhere = 0.7;
  rows[1].environment.busy_elsewhere = 0.9;
  rows[2].environment.busy_elsewhere = 0.1;
  rows[3].probe_moved = true;
  rows[4].basis = Basis::kSimulated;
  EXPECT_EQ(
      machine_state(rows).remarks(),
      (std::vector<std::string>{
          "Other work kept 0.8 of 2 processors busy during 2 of 4 runs: measured claims are not resolved.",
          "The machine's speed moved during the rounds of 1 of 4 runs: their times do not count."}));
}

TEST(ProbeMoved, LeavesTheRowOutOfTheClockAndInTheCounts) {
  std::vector<Row> rows{refined_in(1, {}, 1), refined_in(5, {}, 2), refined_in(1.2, {}, 3)};
  rows[1].probe_moved = true;
  const auto sample_of = [&](const char* measure) {
    RowPointers pointers;
    for (const Row& row : rows) pointers.push_back(&row);
    return sample(pointers, *find_measure(measure));
  };
  EXPECT_EQ(sample_of("refining_seconds").rounds, (std::vector<int>{1, 3}));
  EXPECT_EQ(sample_of("cells").numbers.size(), 3u);
  rows = {rows[1]};
  EXPECT_EQ(sample_of("refining_seconds").absence, "the machine's speed moved during each round");
  EXPECT_EQ(sample_of("cells").absence, "");
}

}  // namespace
}  // namespace podm::bench
