// A table of a TOML file, asked key by key; whatever is not as asked for is refused with its place.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace podm {

/// A TOML file that is not as asked for; what() is "file:line:column: fault".
class TomlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws TomlError when the file is not there or no TOML.
toml::table parse_toml(const std::string& path);
/// Refuses other letters than ASCII's as well: in keys they lead toml++ 3.3 into undefined behaviour.
toml::table parse_ascii_toml(const std::string& path);

/// Every member throws TomlError "file:line:column: fault". The table outlives the section.
class TomlSection {
 public:
  TomlSection(std::string path, const toml::table& table, std::string name)
      : path_(std::move(path)), table_(&table), name_(std::move(name)) {}

  [[noreturn]] void fail(const toml::source_region& place, const std::string& fault) const;
  const toml::source_region& place() const { return table_->source(); }
  const toml::source_region& place(std::string_view key) const { return table_->find(key)->second.source(); }
  /// "file:line:column" of the value at `key`, which is there.
  std::string where(std::string_view key) const;
  bool has(std::string_view key) const { return table_->contains(key); }
  bool is_array(std::string_view key) const { return has(key) && table_->get(key)->is_array(); }
  bool is_table(std::string_view key) const { return has(key) && table_->get(key)->is_table(); }
  bool is_text(std::string_view key, std::string_view text) const {
    return has(key) && table_->get(key)->value<std::string>() == text;
  }

  /// Non-empty; `otherwise` where the key may be absent.
  std::string text(std::string_view key);
  std::string text(std::string_view key, const std::string& otherwise);
  bool flag(std::string_view key);
  double positive(std::string_view key, double otherwise);
  /// From `least` to `most`; the second: `otherwise` when the key is absent.
  double number(std::string_view key, double least, double most);
  double number(std::string_view key, double otherwise, double least, double most);
  /// Any number; nothing when the key is absent.
  std::optional<double> number(std::string_view key);
  std::int64_t count(std::string_view key, std::int64_t least, std::int64_t most);
  std::int64_t count(std::string_view key, std::int64_t otherwise, std::int64_t least, std::int64_t most);
  /// The members of an array, or the one value; none when the key is absent. An empty array is refused.
  std::vector<const toml::node*> values(std::string_view key);
  /// The table at `key`, which is there.
  TomlSection table(std::string_view key);
  /// The table at `key`; an empty one where it is absent.
  TomlSection optional_table(std::string_view key);
  /// The keys in the order of the file; each counts as asked for.
  std::vector<std::string> keys();
  /// The tables [key.NAME], by name.
  std::vector<std::pair<std::string, TomlSection>> tables(std::string_view key);
  /// The tables [[key]], in the order of the file.
  std::vector<TomlSection> table_array(std::string_view key);
  /// Refuses the keys that nobody asked for.
  void done() const;

  std::string text_of(const toml::node& node, std::string_view key) const;
  bool flag_of(const toml::node& node, std::string_view key) const;
  double number_of(const toml::node& node, std::string_view key) const;
  double number_of(const toml::node& node, std::string_view key, double least, double most) const;
  double positive_of(const toml::node& node, std::string_view key) const;
  std::int64_t count_of(const toml::node& node, std::string_view key, std::int64_t least,
                        std::int64_t most) const;

 private:
  std::string told(const toml::source_region& place) const;
  TomlSection member(std::string_view key, std::string_view name, const toml::node& node) const;
  const toml::node* find(std::string_view key);
  const toml::node& required(std::string_view key);

  std::string path_;
  const toml::table* table_;
  std::string name_;
  std::set<std::string, std::less<>> asked_;
};

}  // namespace podm
