// Tests of the rows that `podm-bench compare` matches, its findings, and the values that it calls worse.
#include "gate/compare.h"

#include <gtest/gtest.h>

#include "process/process.h"
#include "rows/results_file.h"
#include "tests/fake_mesher.h"
#include "tests/synthetic_rows.h"

namespace podm::bench {
namespace {

using Rows = std::vector<Row>;

Row row(double seconds, int threads = 1) {
  Row made = synthetic_row("some", {{"threads", threads}});
  made.input.name = made.input.path;
  made.process.peak_rss_bytes = 5000;
  MeshRecord& mesh = mesh_of(made);
  mesh.options = std::make_shared<const Json>(Json{{"radius_mm", 2.0}});
  mesh.threads = {.asked = threads, .used = threads, .as_written = nullptr};
  mesh.phases_s = {{"refine", seconds}, {"write", 50.0}};
  mesh.cells = 1000;
  mesh.cells_per_second = 1000 / seconds;
  WorkRecord& work = mesh.counters.emplace();
  work.insertions = {{"R1", 7}, {"R2", 3}};
  work.removals = 1;
  work.conflict_tests = 100;
  mesh.mesh_sha256 = "aa";
  mesh.verdicts = {{"size", Proof::kPass}};
  return made;
}

// Seven measurements within 2 % of each other.
Rows repeats(double seconds, int threads = 1) {
  Rows rows;
  for (int i = -3; i <= 3; ++i) rows.push_back(row(seconds * (1 + 0.003 * i), threads));
  return rows;
}

bool has(const Comparison& comparison, const std::string& text) {
  return comparison.text.find(text) != std::string::npos;
}

TEST(Compare, WithItselfIsTheSame) {
  const Comparison comparison = compare(repeats(2), repeats(2));
  EXPECT_FALSE(comparison.is_worse);
  EXPECT_TRUE(has(comparison, "same"));
  EXPECT_FALSE(has(comparison, "better"));
}

TEST(Compare, SlowerIsWorseAndFasterIsBetter) {
  const Comparison slower = compare(repeats(2), repeats(2.3));
  EXPECT_TRUE(slower.is_worse);
  EXPECT_TRUE(has(slower, "1.150")) << slower.text;
  EXPECT_TRUE(has(slower, "0.870")) << "cells a second";
  const Comparison faster = compare(repeats(2.3), repeats(2));
  EXPECT_FALSE(faster.is_worse);
  EXPECT_TRUE(has(faster, "better"));
}

TEST(Compare, FewRowsAreNoEvidenceOfTime) {
  const Comparison comparison = compare({row(2)}, {row(4)});
  EXPECT_FALSE(comparison.is_worse);
  EXPECT_TRUE(has(comparison, "2.000"));
  EXPECT_TRUE(has(comparison, "[2.000, 2.000]    0.0 %  not resolved")) << comparison.text;
}

TEST(Compare, IntervalNeedsItsCoverageToDecide) {
  Rows few = repeats(2), few_slower = repeats(3);
  few.pop_back();
  few_slower.pop_back();
  const Comparison unresolved = compare(few, few_slower);
  EXPECT_FALSE(unresolved.is_worse) << unresolved.text;
  EXPECT_TRUE(has(unresolved, "93.8 %  not resolved")) << "six rows on both sides";
  const Comparison resolved = compare(repeats(2), repeats(3));
  EXPECT_TRUE(resolved.is_worse);
  EXPECT_TRUE(has(resolved, "96.9 %  WORSE")) << resolved.text;
}

TEST(Compare, WideIntervalIsNotTheSame) {
  Rows noisy = repeats(2);
  noisy.front() = row(1);
  noisy.back() = row(4);
  const Comparison comparison = compare(noisy, noisy);
  EXPECT_FALSE(comparison.is_worse);
  EXPECT_TRUE(has(comparison, "[0.250, 4.000]   96.9 %  not resolved")) << comparison.text;
}

TEST(Compare, WorkOfOneThreadNeedsNoRepeats) {
  for (const int threads : {1, 2}) {
    Row more = row(2, threads);
    mesh_of(more).counters->conflict_tests = 110;
    EXPECT_EQ(compare({row(2, threads)}, {more}).is_worse, threads == 1);
  }
}

TEST(Compare, LostVerdictsAndStatusComeFirstAndAreWorse) {
  Row unproved = row(2), failed = row(2);
  mesh_of(unproved).verdicts = {{"size", Proof::kFail}};
  failed.status = Status::kFailed;
  failed.mesh.reset();
  for (const Row& bad : {unproved, failed}) {
    const Comparison comparison = compare({row(2)}, {row(2), bad});
    EXPECT_TRUE(comparison.is_worse);
    EXPECT_LT(comparison.text.find("WORSE"), comparison.text.find("median"));
    EXPECT_FALSE(compare({bad}, {row(2)}).is_worse) << "mended";
  }
}

TEST(Compare, AnotherMeshIsReportedOnOneThreadOnly) {
  for (const int threads : {1, 2}) {
    Row other = row(2, threads);
    mesh_of(other).mesh_sha256 = "bb";
    EXPECT_EQ(has(compare({row(2, threads)}, {other}), "another mesh"), threads == 1);
  }
}

TEST(Compare, MatchesOnlyWhatMeasuresTheSame) {
  EXPECT_THROW(compare({row(2)}, {row(2, 2)}), InputError);
  Row other = row(2);
  mesh_of(other).options = std::make_shared<const Json>(Json{{"radius_mm", 3.0}});
  EXPECT_THROW(compare({row(2)}, {other}), InputError);
  Rows both = repeats(2);
  both.push_back(row(9, 2));
  EXPECT_FALSE(compare(repeats(2), both).is_worse);
}

TEST(Compare, RowsOfTwoMachinesAreRefusedAndBothNamed) {
  Row other = row(2);
  other.environment.identity.emplace().vendor = "Elsewhere";
  for (const auto& [a, b] : {std::pair<Rows, Rows>{{row(2)}, {other}}, {{row(2), other}, {row(2)}}}) {
    try {
      compare(a, b);
      ADD_FAILURE() << "compared";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("Elsewhere"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("no identity"), std::string::npos) << error.what();
    }
  }
  other.basis = Basis::kSimulated;
  Row here = row(2);
  here.basis = Basis::kSimulated;
  EXPECT_FALSE(compare({here}, {other}).is_worse) << "virtual time is the same everywhere";
}

TEST(Compare, TakesRecordsOfTheMesherAlone) {
  MeshRecord record = *row(2).mesh;
  record.input.emplace().path = "image.nii";
  const Comparison comparison = compare({row_of(record)}, {row_of(record)});
  EXPECT_FALSE(comparison.is_worse);
  EXPECT_TRUE(has(comparison, "image.nii"));
}

class CompareCommand : public testing::Test {
 protected:
  std::string file(const std::string& name, const Rows& rows) {
    std::string text;
    for (const Row& one : rows) text += as_line(one);
    return folder_.write(name, text);
  }
  int run(const std::string& a, const std::string& b) {
    return run_process({.arguments = {PODM_BENCH, "compare", a, b},
                        .stdout_path = folder_ / "out",
                        .stderr_path = folder_ / "err",
                        .timeout_s = 60})
        .exit_code;
  }
  TemporaryFolder folder_;
};

TEST_F(CompareCommand, ExitCodeReportsAWorseProgram) {
  const std::string a = file("a", repeats(2)), b = file("b", repeats(2.3));
  EXPECT_EQ(run(a, a), 0);
  EXPECT_EQ(run(b, a), 0);
  EXPECT_EQ(run(a, b), 1);
  Json record = Json::parse(kGoodRecord);
  const std::string alone = folder_.write("alone", record.dump() + "\n");
  EXPECT_EQ(run(alone, alone), 0) << read_tail(folder_ / "err", 1000);
  Row elsewhere = row(2);
  elsewhere.environment.cpu = "another";
  EXPECT_EQ(run(a, file("elsewhere", {elsewhere})), 2);
  EXPECT_TRUE(read_tail(folder_ / "err", 1000).find("rows of two machines") != std::string::npos);
  record["cells"] = "many";
  EXPECT_EQ(run(alone, folder_.write("broken", record.dump() + "\n")), 2);
  EXPECT_NE(read_tail(folder_ / "err", 1000).find("broken:1:"), std::string::npos);
  EXPECT_NE(read_tail(folder_ / "err", 1000).find("cells: must be"), std::string::npos);
}

TEST_F(CompareCommand, BadInputExitsWithTwoAndNamesThePlace) {
  const std::string a = file("a", repeats(2));
  EXPECT_EQ(run(a, folder_ / "absent"), 2);
  EXPECT_EQ(run(a, folder_.write("empty", "")), 2);
  const std::string broken = file("broken", repeats(2)) + "";
  std::ofstream(broken, std::ios::app) << "{\"trial\":\n";
  EXPECT_EQ(run(a, broken), 2);
  EXPECT_NE(read_tail(folder_ / "err", 1000).find(broken + ":8:"), std::string::npos);
}

}  // namespace
}  // namespace podm::bench
