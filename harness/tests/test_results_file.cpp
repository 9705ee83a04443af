// Rows outlive crashes, and one run at a time writes them.
#include <gtest/gtest.h>

#include "fake_mesher.h"
#include "rows/results_file.h"
#include "trials/process.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

const std::string kOne = R"({"schema":4,"trial":"one"})" + std::string("\n");
const std::string kTwo = R"({"schema":4,"trial":"two"})" + std::string("\n");

class ResultsFileTest : public testing::Test {
 protected:
  RowsRead repaired(const std::string& text) { return repair_rows(folder_.write("rows.jsonl", text)); }
  std::string text_of(const std::string& name) { return read_tail(folder_ / name, 10000); }
  TemporaryFolder folder_;
};

TEST_F(ResultsFileTest, EachAppendAddsOneWholeLineToWhatWasThere) {
  const std::string path = folder_.write("rows.jsonl", kOne);
  RecordFile(path).append({{"schema", 4}, {"trial", "not UTF-8: \xff"}});
  RecordFile(path).append({{"schema", 4}, {"trial", "two\nlines"}});
  const auto rows = read_rows(path).rows;
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("trial"), "one");
  EXPECT_EQ(rows[2].at("trial"), "two\nlines");
}

TEST_F(ResultsFileTest, UnwritableFileIsRefused) {
  EXPECT_THROW(RecordFile("/no/such/folder/rows.jsonl"), InputError);
  EXPECT_THROW(RecordFile("/dev/full").append(Json::object()), InputError);
  EXPECT_THROW(write_file("/no/such/folder/file", "text"), InputError);
}

TEST_F(ResultsFileTest, SoundFilesStayAsTheyAre) {
  EXPECT_TRUE(repair_rows(folder_ / "absent.jsonl").rows.empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "absent.jsonl"));
  EXPECT_TRUE(repaired("").rows.empty());
  EXPECT_EQ(repaired(kOne + kTwo).rows.size(), 2u);
  EXPECT_EQ(text_of("rows.jsonl"), kOne + kTwo);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "rows.jsonl.broken"));
}

TEST_F(ResultsFileTest, WhereverACrashCutTheLastLineTheOthersAreUsed) {
  for (std::size_t size = 1; size + 1 < kTwo.size(); ++size) {
    std::filesystem::remove(folder_ / "rows.jsonl.broken");
    const std::string half = kTwo.substr(0, size);
    const RowsRead read = repaired(kOne + half);
    EXPECT_EQ(read.rows.size(), 1u);
    EXPECT_EQ(read.broken_line, 2u);
    EXPECT_EQ(text_of("rows.jsonl"), kOne);
    EXPECT_EQ(text_of("rows.jsonl.broken"), half + "\n");
  }
}

TEST_F(ResultsFileTest, LineThatLacksItsEndAloneIsARow) {
  const RowsRead read = repaired(kOne + kTwo.substr(0, kTwo.size() - 1));
  EXPECT_EQ(read.rows.size(), 2u);
  EXPECT_EQ(read.broken_line, 0u);
  EXPECT_EQ(text_of("rows.jsonl"), kOne + kTwo);
}

TEST_F(ResultsFileTest, BrokenLinesAmongOthersAreCollected) {
  repaired(std::string(7, '\0') + "\n" + kOne + "[3]\n" + kTwo);
  EXPECT_EQ(text_of("rows.jsonl"), kOne + kTwo);
  EXPECT_EQ(text_of("rows.jsonl.broken"), std::string(7, '\0') + "\n[3]\n");
  repaired(kOne + "{\"sche");
  EXPECT_TRUE(text_of("rows.jsonl.broken").ends_with("\n[3]\n{\"sche\n")) << "nothing is ever lost";
}

TEST_F(ResultsFileTest, UnknownSchemaIsRefusedWithItsPlaceAndLeftAlone) {
  for (const std::string row :
       {R"({"schema":3})", R"({"schema":5})", R"({"schema":"x"})", R"({"trial":"none"})"}) {
    const std::string path = folder_.write("rows.jsonl", kOne + row + "\n" + "{half");
    try {
      repair_rows(path);
      ADD_FAILURE() << row;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(path + ":2: a row of schema")) << error.what();
    }
    EXPECT_EQ(text_of("rows.jsonl"), kOne + row + "\n" + "{half");
  }
}

TEST_F(ResultsFileTest, FolderIsLockedOnceAndNamedAndFreedAfterwards) {
  const std::string results = folder_ / "new/results";
  {
    const ResultsLock lock(results);
    try {
      const ResultsLock second(results);
      ADD_FAILURE() << "two locks";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(results + "/.lock"), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW(ResultsLock{results});
  EXPECT_THROW(ResultsLock("/proc/results"), InputError);
}

}  // namespace
}  // namespace podm::bench
