// Tests that rows survive crashes, and that one run at a time writes them.
#include <gtest/gtest.h>

#include "process/process.h"
#include "rows/codec.h"
#include "rows/results_file.h"
#include "tests/synthetic_rows.h"
#include "tests/temporary_folder.h"

namespace podm::bench {
namespace {

const std::string kOne = as_line(synthetic_row("one", {}));
const std::string kTwo = as_line(synthetic_row("two", {}));

class ResultsFileTest : public testing::Test {
 protected:
  RowsRead repaired(const std::string& text) { return repair_rows(folder_.write("rows.jsonl", text)); }
  std::string text_of(const std::string& name) { return read_tail(folder_ / name, 10000); }
  TemporaryFolder folder_;
};

TEST_F(ResultsFileTest, EachAppendAddsOneWholeLineToWhatWasThere) {
  const std::string path = folder_.write("rows.jsonl", kOne);
  RecordFile(path).append(synthetic_row("not UTF-8: \xff", {}));
  RecordFile(path).append(synthetic_row("two\nlines", {}));
  const auto rows = read_rows(path).rows;
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].trial, "one");
  EXPECT_EQ(rows[2].trial, "two\nlines");
}

TEST_F(ResultsFileTest, UnwritableFileIsRefused) {
  EXPECT_THROW(RecordFile("/no/such/folder/rows.jsonl"), InputError);
  EXPECT_THROW(RecordFile("/dev/full").append(synthetic_row("one", {})), InputError);
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
  for (std::size_t size = 1; size + 1 < kTwo.size(); size += 60) {
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

TEST_F(ResultsFileTest, RowsReplaceTheNewestLineOfTheirKeyAlone) {
  const std::string path = folder_.write("rows.jsonl", kOne + "{half\n" + kTwo + kOne);
  RecordFile file(path);
  Row one = from_json<Row>(Json::parse(kOne)), absent = one;
  one.probe_moved = true;
  absent.key = "of no line";
  file.replace_newest({one, absent});
  EXPECT_EQ(text_of("rows.jsonl"), kOne + "{half\n" + kTwo + as_line(one));
  file.append_text("more\n");
  EXPECT_TRUE(text_of("rows.jsonl").ends_with(as_line(one) + "more\n")) << "it is appended to the new file";
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

TEST_F(ResultsFileTest, RowThatIsNotAsItsSchemaSaysIsRefusedWithItsPlaceAndLeftAlone) {
  Json without_key = Json::parse(kOne), of_another_type = without_key, nested = without_key;
  without_key.erase("harness_s");
  of_another_type["repeat"] = "first";
  nested["process"]["counters"]["cycles"] = {{"value", 7}};
  for (const auto& [row, fault] : {std::pair{without_key, "has no key 'harness_s'"},
                                   {of_another_type, "repeat: must be an integer"},
                                   {nested, "process/counters/cycles: has no key 'source'"}}) {
    const std::string text = kOne + row.dump() + "\n", path = folder_.write("rows.jsonl", text);
    try {
      repair_rows(path);
      ADD_FAILURE() << fault;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(path + ":2: " + fault)) << error.what();
    }
    EXPECT_EQ(text_of("rows.jsonl"), text);
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
