#include "runtime/toml_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace podm {

namespace {

void refuse_other_letters(const std::string& text, const std::string& path) {
  const auto is_other = [](char letter) { return static_cast<unsigned char>(letter) >= 0x80; };
  const auto other = std::find_if(text.begin(), text.end(), is_other);
  if (other == text.end()) return;
  const auto line_start = std::find(std::reverse_iterator(other), text.rend(), '\n').base();
  throw TomlError(fmt::format("{}:{}:{}: a character that is not ASCII", path,
                              1 + std::count(text.begin(), other, '\n'), 1 + (other - line_start)));
}

std::string text_of_file(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw TomlError(path + ": no such file");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file.is_open()) throw TomlError(path + ": cannot be opened");
  return text.str();
}

TomlValue::Place place_of(const toml::source_region& source) {
  return {static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)};
}

TomlValue value_of(const toml::node& node, const std::string& path, const std::string& key,
                   TomlValue::Place key_place) {
  TomlValue value{path, key, key_place, place_of(node.source()), {}};
  if (const toml::array* array = node.as_array()) {
    auto& members = value.content.emplace<TomlValue::Array>().members;
    for (const toml::node& member : *array) members.push_back(value_of(member, path, key, key_place));
  }
  if (const toml::table* table = node.as_table()) {
    auto& entries = value.content.emplace<TomlValue::Table>().entries;
    for (const auto& [name, entry] : *table)
      entries.push_back(value_of(entry, path, std::string(name.str()), place_of(name.source())));
    std::sort(entries.begin(), entries.end(),
              [](const TomlValue& a, const TomlValue& b) { return a.key_place < b.key_place; });
  }
  if (const auto flag = node.value_exact<bool>()) value.content = *flag;
  if (const auto integer = node.value_exact<std::int64_t>()) value.content = *integer;
  if (const auto real = node.value_exact<double>()) value.content = *real;
  if (const auto text = node.value_exact<std::string>()) value.content = *text;
  return value;
}

}  // namespace

TomlValue parse_toml_text(const std::string& text, const std::string& path) try {
  return value_of(toml::parse(text, path), path, "", {});
} catch (const toml::parse_error& error) {
  const TomlValue::Place place = place_of(error.source());
  throw TomlError(fmt::format("{}:{}:{}: {}", path, place.line, place.column, error.description()));
}

TomlValue parse_toml(const std::string& path) { return parse_toml_text(text_of_file(path), path); }

TomlValue parse_ascii_toml(const std::string& path) {
  const std::string text = text_of_file(path);
  refuse_other_letters(text, path);
  return parse_toml_text(text, path);
}

std::string TomlValue::where(Place at) const { return fmt::format("{}:{}:{}", path, at.line, at.column); }

void TomlValue::fail(const std::string& fault) const { throw TomlError(where(place) + ": " + fault); }

std::string TomlValue::text() const {
  const auto* const value = as<std::string>();
  if (value == nullptr || value->empty()) fail(fmt::format("{} must be a non-empty string", key));
  return *value;
}

bool TomlValue::flag() const {
  const auto* const value = as<bool>();
  if (value == nullptr) fail(fmt::format("{} must be true or false", key));
  return *value;
}

double TomlValue::number() const {
  if (const auto* const integer = as<std::int64_t>()) return static_cast<double>(*integer);
  const auto* const value = as<double>();
  if (value == nullptr || !std::isfinite(*value)) fail(fmt::format("{} must be a number", key));
  return *value;
}

double TomlValue::number(double least, double most) const {
  const double value = number();
  if (value < least || value > most) fail(fmt::format("{} must be a number from {} to {}", key, least, most));
  return value;
}

double TomlValue::positive() const {
  const double value = number();
  if (!(value > 0)) fail(fmt::format("{} must be a positive number", key));
  return value;
}

std::int64_t TomlValue::count(std::int64_t least, std::int64_t most) const {
  const auto* const value = as<std::int64_t>();
  if (value == nullptr || *value < least || *value > most)
    fail(fmt::format("{} must be an integer from {} to {}", key, least, most));
  return *value;
}

TomlSection::TomlSection(const TomlValue& table, std::string name) : table_(&table), name_(std::move(name)) {
  const auto* const found = table.as<TomlValue::Table>();
  if (found == nullptr) fail(name_ + " must be a table");
  entries_ = &found->entries;
}

std::vector<TomlValue> TomlSection::values(std::string_view key) {
  const TomlValue* value = find(key);
  if (value == nullptr) return {};
  const auto* const array = value->as<TomlValue::Array>();
  if (array == nullptr) return {*value};
  if (array->members.empty()) value->fail(fmt::format("{} must not be empty", key));
  return array->members;
}

TomlSection TomlSection::optional_table(std::string_view key) {
  static const TomlValue kEmpty{"", "", {}, {}, TomlValue::Table{}};
  return {find(key) == nullptr ? kEmpty : required(key), std::string(key)};
}

std::vector<std::string> TomlSection::keys() {
  std::vector<std::string> names;
  for (const TomlValue& value : *entries_) names.push_back(value.key);
  asked_.insert(names.begin(), names.end());
  return names;
}

std::vector<std::pair<std::string, TomlSection>> TomlSection::tables(std::string_view key) {
  const TomlValue& value = required(key);
  const auto* const table = value.as<TomlValue::Table>();
  if (table == nullptr) value.fail(fmt::format("write each of {0} as a table, [{0}.NAME]", key));
  std::vector<std::pair<std::string, TomlSection>> sections;
  for (const TomlValue& entry : table->entries)
    sections.emplace_back(entry.key, TomlSection(entry, fmt::format("[{}.{}]", key, entry.key)));
  return sections;
}

std::vector<TomlSection> TomlSection::table_array(std::string_view key) {
  const TomlValue& value = required(key);
  const auto* const array = value.as<TomlValue::Array>();
  const auto is_table = [](const TomlValue& member) { return member.as<TomlValue::Table>() != nullptr; };
  if (array == nullptr || array->members.empty() ||
      !std::all_of(array->members.begin(), array->members.end(), is_table))
    value.fail(fmt::format("write each of {0} as a table, [[{0}]]", key));
  std::vector<TomlSection> sections;
  for (const TomlValue& member : array->members) sections.emplace_back(member, fmt::format("[[{}]]", key));
  return sections;
}

void TomlSection::done() const {
  for (const TomlValue& value : *entries_)
    if (!asked_.contains(value.key))
      throw TomlError(fmt::format("{}: {} has no key '{}'; it has {}", value.where(value.key_place), name_,
                                  value.key, fmt::join(asked_, ", ")));
}

const TomlValue* TomlSection::get(std::string_view key) const {
  for (const TomlValue& value : *entries_)
    if (value.key == key) return &value;
  return nullptr;
}

const TomlValue* TomlSection::find(std::string_view key) {
  asked_.emplace(key);
  return get(key);
}

const TomlValue& TomlSection::required(std::string_view key) {
  const TomlValue* value = find(key);
  if (value == nullptr) table_->fail(fmt::format("{} needs the key '{}'", name_, key));
  return *value;
}

}  // namespace podm
