// Rows, the file they go to, the environment beside them, and the table.
#include <gtest/gtest.h>

#include <sstream>

#include "environment.h"
#include "fake_mesher.h"
#include "record.h"
#include "table.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

struct RowTest : testing::Test {
  RowTest() {
    experiment.name = "exp";
    trial.name = "some";
    trial.image = "folder/image.nii";
    trial.timeout_s = 20;
    good.status = Status::kOk;
    good.record = Json::parse(kGoodRecord);
    good.image_size = {10, 10, 10};
    good.process.end = ProcessOutcome::End::kExited;
    good.process.peak_rss_bytes = 106'000;
    failed.reason = "killed by signal 6";
    failed.process.end = ProcessOutcome::End::kSignalled;
    failed.process.signal = 6;
    failed.stderr_tail = "not UTF-8: \xff\n";
  }
  Experiment experiment;
  Trial trial;
  TrialResult good, failed;
};

TEST_F(RowTest, HoldsTheMesherRecordAndWhatTheHarnessSaw) {
  const Json row = make_row(experiment, trial, good, {{"cpu", "some cpu"}});
  for (const auto& [key, value] : good.record.items()) {
    if (key == "input") continue;  // the harness adds the size
    EXPECT_EQ(row.at(key), value) << key;
  }
  EXPECT_EQ(row.at("experiment"), "exp");
  EXPECT_EQ(row.at("trial"), "some");
  EXPECT_EQ(row.at("status"), "ok");
  EXPECT_EQ(row.at("input").at("sha256"), "00");
  EXPECT_EQ(row.at("input").at("size"), good.image_size);
  EXPECT_EQ(row.at("process").at("exit_code"), 0);
  EXPECT_TRUE(row.at("process").at("signal").is_null());
  EXPECT_EQ(row.at("environment").at("cpu"), "some cpu");
}

TEST_F(RowTest, OfAFailureSaysWhyAndOnWhat) {
  const Json row = make_row(experiment, trial, failed, Json::object());
  EXPECT_EQ(row.at("status"), "failed");
  EXPECT_EQ(row.at("reason"), failed.reason);
  EXPECT_EQ(row.at("input").at("path"), trial.image);
  EXPECT_EQ(row.at("process").at("signal"), 6);
  EXPECT_TRUE(row.at("process").at("exit_code").is_null());
  EXPECT_FALSE(row.contains("cells"));
}

TEST_F(RowTest, MemoryPerCellLeavesOutLabelsAndTransform) {
  // 1000 voxels of 2 + 4 bytes, 1000 cells.
  EXPECT_DOUBLE_EQ(bytes_per_cell_beyond_image(good).value(), 100);
  EXPECT_FALSE(bytes_per_cell_beyond_image(failed).has_value());
  good.record["cells"] = 0u;
  EXPECT_FALSE(bytes_per_cell_beyond_image(good).has_value());
}

TEST_F(RowTest, EachAppendAddsOneWholeLineToWhatWasThere) {
  const TemporaryFolder folder;
  const std::string path = folder.write("rows.jsonl", "{\"old\":1}\n");
  for (const TrialResult& result : {good, failed})
    RecordFile(path).append(make_row(experiment, trial, result, Json::object()));
  std::ifstream file(path);
  std::vector<Json> rows;
  for (std::string line; std::getline(file, line);) rows.push_back(Json::parse(line));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("old"), 1);
  EXPECT_EQ(rows[1].at("status"), "ok");
  EXPECT_EQ(rows[2].at("status"), "failed");
}

TEST_F(RowTest, UnwritableFileIsRefused) {
  EXPECT_THROW(RecordFile("/no/such/folder/rows.jsonl"), InputError);
  EXPECT_THROW(RecordFile("/dev/full").append(Json::object()), InputError);
}

TEST_F(RowTest, TableIsAlignedAndTellsEveryTrial) {
  good.record["cells"] = 1234567u;
  Trial other = trial;
  other.name = "another-with-a-long-name";
  std::istringstream text(format_table({{trial, good}, {other, failed}}));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_NE(lines[1].find("1 234 567"), std::string::npos);
  EXPECT_NE(lines[1].find(" 2.00 "), std::string::npos) << "seconds leave out writing";
  EXPECT_NE(lines[2].find(failed.reason), std::string::npos);
  const std::size_t last_column = lines[0].find("guarantees");
  EXPECT_EQ(lines[1].find("met"), last_column);
  EXPECT_EQ(lines[2].find("failed:"), last_column);
}

TEST(Environment, KnowsThisMachineOrSaysWhyNot) {
  const TemporaryFolder folder;
  const Json now = environment(folder.path());
  for (const char* key : {"cpu", "cores", "governor", "transparent_huge_pages", "kernel", "load_average",
                          "memory_bytes", "compiler", "compiler_flags", "build_type", "sources"}) {
    ASSERT_TRUE(now.contains(key)) << key;
    EXPECT_NE(now[key], "") << key;
    EXPECT_NE(now[key], Json()) << key;
  }
  EXPECT_GE(now["cores"]["usable"], 1);
  EXPECT_GE(now["cores"]["online"], now["cores"]["usable"]);
  EXPECT_GT(now["memory_bytes"]["total"], now["memory_bytes"]["available"]);
  EXPECT_TRUE(now["kernel"].get<std::string>().starts_with("Linux"));
}

}  // namespace
}  // namespace podm::bench
