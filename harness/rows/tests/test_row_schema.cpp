// Tests that the structs of rows, the schema for other programs, and the committed rows agree.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "rows/results_file.h"
#include "tests/schema_of.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

const std::string kResults = PODM_RESULTS;

Json committed_schema() {
  std::ifstream file(kResults + "/schema/podm-bench-row.schema.json");
  return Json::parse(file);
}

// Returns the differences between a part of the schema and the fields; the keys of `elsewhere` are in another
// part.
std::vector<std::string> differences(Shape fields, const Json& part, const Json& root,
                                     const std::set<std::string>& elsewhere = {}) {
  std::vector<std::string> faults;
  Shape schema = shape_in(part, root);
  schema.types.insert("object");
  for (const std::string& key : elsewhere) {
    fields.keys.erase(key);
    schema.keys.erase(key);
  }
  compare_shapes(fields, schema, "row", faults);
  return faults;
}

Shape shape_of_row() { return shape_of_fields(std::tuple_cat(Row::fields_before(), Row::fields_after())); }

std::vector<std::string> differences_from(const Json& schema) {
  std::vector<std::string> faults = differences(shape_of_row(), schema, schema);
  const auto add = [&](const std::vector<std::string>& more) {
    faults.insert(faults.end(), more.begin(), more.end());
  };
  add(differences(shape_of<MeshRecord>(), schema["then"], schema, {"schema", "input"}));
  add(differences(shape_of<MemoryLevelsRecord>(), schema["else"]["anyOf"][1], schema, {"status"}));
  return faults;
}

TEST(RowSchema, IsThatOfTheFields) {
  const auto faults = differences_from(committed_schema());
  EXPECT_TRUE(faults.empty()) << fmt::format("{}", fmt::join(faults, "\n"));
}

// Each change of a place of the schema is detected.
TEST(RowSchema, DifferencesAreSeen) {
  const Json schema = committed_schema();
  const auto changed = [&](const char* place, const Json& value) {
    Json other = schema;
    other[Json::json_pointer(place)] = value;
    return other;
  };
  const std::pair<const char*, Json> changes[] = {
      {"/properties/reason/type", "integer"},      // a type
      {"/properties/mesh_bytes/type", "integer"},  // no longer null
      {"/properties/process/properties/wall_s/type", Json{"number", "null"}},
      {"/properties/process/properties/nice_s", Json{{"type", "number"}}},  // an additional key
      {"/properties/status/enum", Json{"ok", "lost"}},
      {"/properties/environment/properties/cpu", Json{{"type", "object"}}},
      {"/then/properties/cells/type", "string"},
      {"/then/required", Json{"cells"}},
      {"/$defs/latency/properties/node/type", "string"},
      {"/$defs/counter/oneOf/1/required", Json{"value"}},
      {"/properties/side_by_side/items/properties/cells/type", "number"},
  };
  for (const auto& [place, value] : changes)
    EXPECT_FALSE(differences_from(changed(place, value)).empty()) << place;
  for (const char* place :
       {"/properties/replay", "/then/properties/overhead_s", "/$defs/program/properties/version",
        "/properties/environment/properties/governor"}) {
    Json other = schema;
    const Json::json_pointer pointer(place);
    other[pointer.parent_pointer()].erase(pointer.back());
    EXPECT_FALSE(differences_from(other).empty()) << place;
  }
}

// Committed rows are read, and written again unchanged, byte by byte.
TEST(RowSchema, CommittedRowsAreReadAndWrittenAsTheyWere) {
  std::size_t num_rows = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kResults + "/reference")) {
    const std::string path = entry.path().string(), name = entry.path().filename().string();
    if (!name.ends_with(".jsonl") || name == "radii.jsonl") continue;
    if (entry.path().parent_path().filename() == "gate") continue;  // gate/gate_rounds.h and gate_evidence.h
    const RowsRead read = read_rows(path);
    EXPECT_EQ(read.broken_line, 0u) << path;
    std::string written;
    for (const Row& row : read.rows) written += as_line(row);
    EXPECT_TRUE(written == read.whole) << path;
    num_rows += read.rows.size();
  }
  EXPECT_GT(num_rows, 300u);
}

}  // namespace
}  // namespace podm::bench
