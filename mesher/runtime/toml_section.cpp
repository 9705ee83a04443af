#include "runtime/toml_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

namespace podm {

namespace {

void refuse_missing(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw TomlError(path + ": no such file");
}

void refuse_other_letters(const std::string& text, const std::string& path) {
  const auto is_other = [](char letter) { return static_cast<unsigned char>(letter) >= 0x80; };
  const auto other = std::find_if(text.begin(), text.end(), is_other);
  if (other == text.end()) return;
  const auto line_start = std::find(std::reverse_iterator(other), text.rend(), '\n').base();
  throw TomlError(fmt::format("{}:{}:{}: a character that is not ASCII", path,
                              1 + std::count(text.begin(), other, '\n'), 1 + (other - line_start)));
}

template <class Parse>
toml::table parsed(const std::string& path, const Parse& parse) try {
  return parse();
} catch (const toml::parse_error& error) {
  const toml::source_position& place = error.source().begin;
  throw TomlError(fmt::format("{}:{}:{}: {}", path, place.line, place.column, error.description()));
}

}  // namespace

toml::table parse_toml(const std::string& path) {
  refuse_missing(path);
  return parsed(path, [&] { return toml::parse_file(path); });
}

toml::table parse_ascii_toml(const std::string& path) {
  refuse_missing(path);
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file.is_open()) throw TomlError(path + ": cannot be opened");
  refuse_other_letters(text.str(), path);
  return parsed(path, [&] { return toml::parse(text.str(), path); });
}

std::string TomlSection::location(const toml::source_region& place) const {
  return fmt::format("{}:{}:{}", path_, place.begin.line, place.begin.column);
}

void TomlSection::fail(const toml::source_region& place, const std::string& fault) const {
  throw TomlError(location(place) + ": " + fault);
}

std::string TomlSection::where(std::string_view key) const { return location(place(key)); }

std::string TomlSection::text_of(const toml::node& node, std::string_view key) const {
  const auto value = node.value_exact<std::string>();
  if (!value || value->empty()) fail(node.source(), fmt::format("{} must be a non-empty string", key));
  return *value;
}

double TomlSection::number_of(const toml::node& node, std::string_view key) const {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value)) fail(node.source(), fmt::format("{} must be a number", key));
  return *value;
}

double TomlSection::number_of(const toml::node& node, std::string_view key, double least, double most) const {
  const double value = number_of(node, key);
  if (value < least || value > most)
    fail(node.source(), fmt::format("{} must be a number from {} to {}", key, least, most));
  return value;
}

double TomlSection::positive_of(const toml::node& node, std::string_view key) const {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value || !(*value > 0) || !(*value < std::numeric_limits<double>::infinity()))
    fail(node.source(), fmt::format("{} must be a positive number", key));
  return *value;
}

std::int64_t TomlSection::count_of(const toml::node& node, std::string_view key, std::int64_t least,
                                   std::int64_t most) const {
  const auto value = node.value_exact<std::int64_t>();
  if (!value || *value < least || *value > most)
    fail(node.source(), fmt::format("{} must be an integer from {} to {}", key, least, most));
  return *value;
}

std::string TomlSection::text(std::string_view key) { return text_of(required(key), key); }

std::string TomlSection::text(std::string_view key, const std::string& otherwise) {
  const toml::node* node = find(key);
  return node == nullptr ? otherwise : text_of(*node, key);
}

bool TomlSection::flag(std::string_view key) {
  const toml::node* node = find(key);
  return node != nullptr && flag_of(*node, key);
}

bool TomlSection::flag_of(const toml::node& node, std::string_view key) const {
  const auto value = node.value_exact<bool>();
  if (!value) fail(node.source(), fmt::format("{} must be true or false", key));
  return *value;
}

double TomlSection::positive(std::string_view key, double otherwise) {
  const toml::node* node = find(key);
  return node == nullptr ? otherwise : positive_of(*node, key);
}

std::optional<double> TomlSection::number(std::string_view key) {
  const toml::node* node = find(key);
  return node == nullptr ? std::nullopt : std::optional(number_of(*node, key));
}

double TomlSection::number(std::string_view key, double least, double most) {
  return number_of(required(key), key, least, most);
}

double TomlSection::number(std::string_view key, double otherwise, double least, double most) {
  const toml::node* node = find(key);
  return node == nullptr ? otherwise : number_of(*node, key, least, most);
}

std::int64_t TomlSection::count(std::string_view key, std::int64_t least, std::int64_t most) {
  return count_of(required(key), key, least, most);
}

std::int64_t TomlSection::count(std::string_view key, std::int64_t otherwise, std::int64_t least,
                                std::int64_t most) {
  const toml::node* node = find(key);
  return node == nullptr ? otherwise : count_of(*node, key, least, most);
}

std::vector<const toml::node*> TomlSection::values(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  if (!node->is_array()) return {node};
  std::vector<const toml::node*> members;
  for (const toml::node& member : *node->as_array()) members.push_back(&member);
  if (members.empty()) fail(node->source(), fmt::format("{} must not be empty", key));
  return members;
}

TomlSection TomlSection::table(std::string_view key) {
  const toml::node& node = required(key);
  if (!node.is_table()) fail(node.source(), fmt::format("{} must be a table", key));
  return {path_, *node.as_table(), std::string(key)};
}

TomlSection TomlSection::optional_table(std::string_view key) {
  static const toml::table kEmpty;
  return find(key) == nullptr ? TomlSection(path_, kEmpty, std::string(key)) : table(key);
}

std::vector<std::string> TomlSection::keys() {
  std::vector<const toml::key*> keys;
  for (const auto& [key, node] : *table_) keys.push_back(&key);
  std::sort(keys.begin(), keys.end(), [](const toml::key* a, const toml::key* b) {
    return std::pair(a->source().begin.line, a->source().begin.column) <
           std::pair(b->source().begin.line, b->source().begin.column);
  });
  std::vector<std::string> names;
  for (const toml::key* key : keys) names.emplace_back(key->str());
  asked_.insert(names.begin(), names.end());
  return names;
}

std::vector<std::pair<std::string, TomlSection>> TomlSection::tables(std::string_view key) {
  const toml::node& node = required(key);
  if (!node.is_table()) fail(node.source(), fmt::format("write each of {0} as a table, [{0}.NAME]", key));
  std::vector<std::pair<std::string, TomlSection>> sections;
  for (const auto& [name, table] : *node.as_table())
    sections.emplace_back(name.str(), member(key, name.str(), table));
  return sections;
}

std::vector<TomlSection> TomlSection::table_array(std::string_view key) {
  const toml::node& node = required(key);
  if (!node.is_array_of_tables())
    fail(node.source(), fmt::format("write each of {0} as a table, [[{0}]]", key));
  std::vector<TomlSection> sections;
  for (const toml::node& table : *node.as_array())
    sections.emplace_back(path_, *table.as_table(), fmt::format("[[{}]]", key));
  return sections;
}

void TomlSection::done() const {
  for (const auto& [key, node] : *table_)
    if (!asked_.contains(key.str()))
      fail(key.source(),
           fmt::format("{} has no key '{}'; it has {}", name_, key.str(), fmt::join(asked_, ", ")));
}

TomlSection TomlSection::member(std::string_view key, std::string_view name, const toml::node& node) const {
  const std::string title = fmt::format("[{}.{}]", key, name);
  if (!node.is_table()) fail(node.source(), fmt::format("{} must be a table", title));
  return {path_, *node.as_table(), title};
}

const toml::node* TomlSection::find(std::string_view key) {
  asked_.emplace(key);
  return table_->get(key);
}

const toml::node& TomlSection::required(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) fail(table_->source(), fmt::format("{} needs the key '{}'", name_, key));
  return *node;
}

}  // namespace podm
