#include "schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "errors.h"

namespace podm::verify {

namespace {

using Json = nlohmann::json;

constexpr const char* kSchema = "podm-schedule/1";
constexpr double kMostGrid = 0x1p40;

class Lines {
 public:
  explicit Lines(const std::string& path) : path_(path), file_(path) {
    if (!file_) throw InputError(fmt::format("{}: cannot be read", path));
  }
  bool next(Json& json) {
    std::string text;
    if (!std::getline(file_, text)) return false;
    ++line_;
    json = Json::parse(text, nullptr, false);
    if (!json.is_object()) fail("is not a JSON object");
    return true;
  }
  [[noreturn]] void fail(const std::string& fault) const {
    throw InputError(fmt::format("{}: line {}: {}", path_, line_, fault));
  }

 private:
  std::string path_;
  std::ifstream file_;
  std::size_t line_ = 0;
};

bool is_finite(const Json& json) { return json.is_number() && std::isfinite(json.get<double>()); }

double number(const Json& json, const char* key, const Lines& lines) {
  if (!json.contains(key) || !is_finite(json[key])) lines.fail(fmt::format("no number '{}'", key));
  return json[key].get<double>();
}

template <class Count>
Count count(const Json& json, const char* key, const Lines& lines) {
  if (!json.contains(key) || !json[key].is_number_unsigned() ||
      json[key].get<std::uint64_t>() > std::numeric_limits<Count>::max())
    lines.fail(fmt::format("no count '{}'", key));
  return json[key].get<Count>();
}

// Compares the number as a double, which does not wrap, however large it is.
bool is_grid_number(const Json& json) {
  return json.is_number_integer() && std::fabs(json.get<double>()) <= kMostGrid;
}

Leaf leaf(const Json& json, const Lines& lines) {
  if (!json.is_array() || json.size() != 4 || !std::all_of(json.begin(), json.end(), is_grid_number))
    lines.fail("a leaf is not [i, j, k, side] with numbers up to 2^40");
  const Leaf leaf{{json[0], json[1], json[2]}, json[3]};
  if (leaf.side <= 0 || !std::has_single_bit(static_cast<std::uint64_t>(leaf.side)))
    lines.fail("a leaf's side is not a power of two");
  return leaf;
}

std::uint32_t leaf_id(const Json& json, const Schedule& schedule, const Lines& lines) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() >= schedule.leaves.size())
    lines.fail("names a leaf that the grid does not have");
  return json.get<std::uint32_t>();
}

Activation activation(const Json& json, const Schedule& schedule, const Lines& lines) {
  Activation a;
  a.leaf = leaf_id(json.value("leaf", Json()), schedule, lines);
  a.node = count<std::uint32_t>(json, "node", lines);
  a.begin_s = number(json, "begin_s", lines);
  a.end_s = number(json, "end_s", lines);
  if (a.end_s < a.begin_s) lines.fail("ends before it begins");
  a.operations = count<std::uint64_t>(json, "operations", lines);
  a.deferred = count<std::uint64_t>(json, "deferred", lines);
  if (!json.contains("touched_leaves") || !json["touched_leaves"].is_array())
    lines.fail("no list 'touched_leaves'");
  for (const Json& touched : json["touched_leaves"])
    a.touched_leaves.push_back(leaf_id(touched, schedule, lines));
  return a;
}

}  // namespace

Schedule read_schedule(const std::string& path) {
  Lines lines(path);
  Json json;
  if (!lines.next(json) || json.value("schema", Json()) != kSchema)
    throw InputError(fmt::format("{}: line 1: is not the header of a schedule ({})", path, kSchema));
  Schedule schedule;
  schedule.path = path;
  schedule.algorithm =
      json.value("algorithm", Json()).is_string() ? json["algorithm"].get<std::string>() : "";
  const Json matrix = json.value("mesh_to_grid", Json());
  if (!matrix.is_array() || matrix.size() != 12 || !std::all_of(matrix.begin(), matrix.end(), is_finite))
    lines.fail("'mesh_to_grid' is not 12 numbers");
  schedule.mesh_to_grid = matrix.get<std::array<double, 12>>();
  const Json leaves = json.value("leaves", Json());
  if (!leaves.is_array()) lines.fail("no list 'leaves'");
  for (const Json& entry : leaves) schedule.leaves.push_back(leaf(entry, lines));
  while (lines.next(json)) schedule.activations.push_back(activation(json, schedule, lines));
  return schedule;
}

}  // namespace podm::verify
