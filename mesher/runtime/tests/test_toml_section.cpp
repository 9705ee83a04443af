// Tests of sections of TOML files: the types, places and order of values, and the entries that are refused.
#include "runtime/toml_section.h"

#include <gtest/gtest.h>

#include <functional>

namespace podm {
namespace {

// Returns the fault that reading reports; empty if there is none.
std::string fault_of(const std::string& text, const std::function<void(TomlSection&)>& read) {
  const TomlValue table = parse_toml_text(text, "a.toml");
  TomlSection section(table, "a file");
  try {
    read(section);
    section.done();
  } catch (const TomlError& error) {
    return error.what();
  }
  return "";
}

TEST(TomlValue, HasExactlyOneType) {
  const TomlValue file = parse_toml_text(
      "flag = true\ninteger = 3\nreal = 3.0\ntext = '3'\narray = [3]\ntable = {}\ndate = 2026-11-26\n",
      "a.toml");
  const std::vector<TomlValue>& entries = file.as<TomlValue::Table>()->entries;
  ASSERT_EQ(entries.size(), 7u);
  for (const TomlValue& entry : entries) {
    EXPECT_EQ(entry.as<bool>() != nullptr, entry.key == "flag") << entry.key;
    EXPECT_EQ(entry.as<std::int64_t>() != nullptr, entry.key == "integer") << entry.key;
    EXPECT_EQ(entry.as<double>() != nullptr, entry.key == "real") << entry.key;
    EXPECT_EQ(entry.as<std::string>() != nullptr, entry.key == "text") << entry.key;
    EXPECT_EQ(entry.as<TomlValue::Array>() != nullptr, entry.key == "array") << entry.key;
    EXPECT_EQ(entry.as<TomlValue::Table>() != nullptr, entry.key == "table") << entry.key;
  }
  EXPECT_EQ(entries[1].number(), 3) << "an integer is a number";
  EXPECT_THROW(entries[2].count(0, 9), TomlError) << "a real number is no count";
  EXPECT_THROW(entries[6].text(), TomlError);
}

TEST(TomlValue, KnowsItsPlaceAndMembersOfArraysTheirKey) {
  const TomlValue file = parse_toml_text("[a]\nb = [1, [2, 3]]\n", "a.toml");
  TomlSection section(file, "a file");
  const std::vector<TomlValue> members = section.table("a").values("b");
  ASSERT_EQ(members.size(), 2u);
  EXPECT_EQ(members[0].where(members[0].place), "a.toml:2:6");
  EXPECT_EQ(members[0].key, "b");
  const auto* const inner = members[1].as<TomlValue::Array>();
  ASSERT_NE(inner, nullptr);
  EXPECT_EQ(inner->members.at(1).place, (TomlValue::Place{2, 13}));
  EXPECT_EQ(inner->members.at(1).key, "b");
}

TEST(TomlSection, ListsKeysAndTablesInTheOrderOfTheFile) {
  const TomlValue file =
      parse_toml_text("z = 1\na = 2\n[t.y]\n[t.b]\n[[u]]\nn = 2\n[[u]]\nn = 1\n", "a.toml");
  TomlSection section(file, "a file");
  EXPECT_EQ(section.keys(), (std::vector<std::string>{"z", "a", "t", "u"}));
  std::string names;
  for (const auto& [name, table] : section.tables("t")) names += name;
  EXPECT_EQ(names, "yb");
  std::vector<std::int64_t> numbers;
  for (TomlSection& each : section.table_array("u")) numbers.push_back(each.count("n", 0, 9));
  EXPECT_EQ(numbers, (std::vector<std::int64_t>{2, 1}));
  EXPECT_NO_THROW(section.done());
}

TEST(TomlSection, RefusesWhatWasNotReadAtTheKeyAndWhatIsInvalidAtTheValue) {
  const auto read_a = [](TomlSection& section) { section.count("a", 0, 9); };
  EXPECT_EQ(fault_of("a = 1\n", read_a), "");
  EXPECT_EQ(fault_of("a = 1\nb = 2\n", read_a), "a.toml:2:1: a file has no key 'b'; it has a");
  EXPECT_EQ(fault_of("a = 10\n", read_a), "a.toml:1:5: a must be an integer from 0 to 9");
  EXPECT_TRUE(fault_of("b = 1\n", read_a).ends_with("a file needs the key 'a'"));
  const auto fail_at_a = [](TomlSection& section) { section.fail("a", "why"); };
  EXPECT_EQ(fault_of("\n a = 1\n", fail_at_a), "a.toml:2:6: why");
  EXPECT_TRUE(fault_of("b = 1\n", fail_at_a).ends_with(": why")) << "at the table, which has no such key";
  EXPECT_THROW(parse_toml_text("a = = 1\n", "a.toml"), TomlError);
  EXPECT_THROW(parse_toml("/absent.toml"), TomlError);
}

}  // namespace
}  // namespace podm
