#include "schedule.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "errors.h"

namespace podm::verify {

namespace {

using Json = nlohmann::json;

constexpr const char* kSchema = "podm-schedule/1";
constexpr std::int64_t kMostGrid = std::int64_t{1} << 40;

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
    if (!json.is_object()) fail("is no JSON object");
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

double number(const Json& json, const char* key, const Lines& lines) {
  if (!json.contains(key) || !json[key].is_number() || !std::isfinite(json[key].get<double>()))
    lines.fail(fmt::format("no number '{}'", key));
  return json[key].get<double>();
}

std::uint64_t count(const Json& json, const char* key, const Lines& lines) {
  if (!json.contains(key) || !json[key].is_number_unsigned()) lines.fail(fmt::format("no count '{}'", key));
  return json[key].get<std::uint64_t>();
}

Leaf leaf(const Json& json, const Lines& lines) {
  const bool is_four_integers =
      json.is_array() && json.size() == 4 &&
      std::all_of(json.begin(), json.end(), [](const Json& x) { return x.is_number_integer(); });
  if (!is_four_integers) lines.fail("a leaf is not [i, j, k, side]");
  Leaf leaf{{json[0], json[1], json[2]}, json[3]};
  const bool is_small = std::all_of(leaf.corner.begin(), leaf.corner.end(),
                                    [](std::int64_t x) { return std::llabs(x) <= kMostGrid; });
  if (!is_small || leaf.side <= 0 || leaf.side > kMostGrid ||
      !std::has_single_bit(static_cast<std::uint64_t>(leaf.side)))
    lines.fail("a leaf's side is no power of two, or it lies too far out");
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
  a.node = static_cast<std::uint32_t>(count(json, "node", lines));
  a.begin_s = number(json, "begin_s", lines);
  a.end_s = number(json, "end_s", lines);
  if (a.end_s < a.begin_s) lines.fail("ends before it begins");
  a.operations = count(json, "operations", lines);
  a.deferred = count(json, "deferred", lines);
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
    throw InputError(fmt::format("{}: line 1: is not the head of a schedule ({})", path, kSchema));
  Schedule schedule;
  schedule.path = path;
  schedule.algorithm =
      json.value("algorithm", Json()).is_string() ? json["algorithm"].get<std::string>() : "";
  const Json matrix = json.value("mesh_to_grid", Json());
  if (!matrix.is_array() || matrix.size() != 12) lines.fail("'mesh_to_grid' is not 12 numbers");
  for (std::size_t i = 0; i < 12; ++i) {
    if (!matrix[i].is_number()) lines.fail("'mesh_to_grid' is not 12 numbers");
    schedule.mesh_to_grid[i] = matrix[i].get<double>();
  }
  const Json leaves = json.value("leaves", Json());
  if (!leaves.is_array()) lines.fail("no list 'leaves'");
  for (const Json& entry : leaves) schedule.leaves.push_back(leaf(entry, lines));
  while (lines.next(json)) schedule.activations.push_back(activation(json, schedule, lines));
  return schedule;
}

}  // namespace podm::verify
