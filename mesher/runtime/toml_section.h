// A table of a TOML file, read key by key. An unexpected or invalid entry is refused with its place.
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

/// A TOML file with an invalid entry; what() is "file:line:column: fault".
class TomlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws TomlError if the file does not exist or is not valid TOML.
toml::table parse_toml(const std::string& path);
/// Also refuses non-ASCII characters: in keys they lead toml++ 3.3 into undefined behaviour.
toml::table parse_ascii_toml(const std::string& path);

/// Every member throws TomlError "file:line:column: fault". The table must outlive the section.
class TomlSection {
 public:
  TomlSection(std::string path, const toml::table& table, std::string name)
      : path_(std::move(path)), table_(&table), name_(std::move(name)) {}

  [[noreturn]] void fail(const toml::source_region& place, const std::string& fault) const;
  const toml::source_region& place() const { return table_->source(); }
  const toml::source_region& place(std::string_view key) const { return table_->find(key)->second.source(); }
  /// Returns "file:line:column" of the value at `key`, which must exist.
  std::string where(std::string_view key) const;
  bool has(std::string_view key) const { return table_->contains(key); }
  bool is_array(std::string_view key) const { return has(key) && table_->get(key)->is_array(); }
  bool is_table(std::string_view key) const { return has(key) && table_->get(key)->is_table(); }
  bool is_text(std::string_view key, std::string_view text) const {
    return has(key) && table_->get(key)->value<std::string>() == text;
  }

  /// The text must not be empty. The second function returns `otherwise` if the key is absent.
  std::string text(std::string_view key);
  std::string text(std::string_view key, const std::string& otherwise);
  bool flag(std::string_view key);
  double positive(std::string_view key, double otherwise);
  /// The value must be from `least` to `most`. The second function returns `otherwise` if the key is absent.
  double number(std::string_view key, double least, double most);
  double number(std::string_view key, double otherwise, double least, double most);
  /// Returns any number; nothing if the key is absent.
  std::optional<double> number(std::string_view key);
  std::int64_t count(std::string_view key, std::int64_t least, std::int64_t most);
  std::int64_t count(std::string_view key, std::int64_t otherwise, std::int64_t least, std::int64_t most);
  /// Returns the members of an array, or the single value; empty if the key is absent. Refuses an empty
  /// array.
  std::vector<const toml::node*> values(std::string_view key);
  /// Returns the table at `key`, which must exist.
  TomlSection table(std::string_view key);
  /// Returns the table at `key`; an empty one if it is absent.
  TomlSection optional_table(std::string_view key);
  /// Returns the keys in the order of the file; each counts as read.
  std::vector<std::string> keys();
  /// Returns the tables [key.NAME], by name.
  std::vector<std::pair<std::string, TomlSection>> tables(std::string_view key);
  /// Returns the tables [[key]], in the order of the file.
  std::vector<TomlSection> table_array(std::string_view key);
  /// Refuses keys that were not read.
  void done() const;

  std::string text_of(const toml::node& node, std::string_view key) const;
  bool flag_of(const toml::node& node, std::string_view key) const;
  double number_of(const toml::node& node, std::string_view key) const;
  double number_of(const toml::node& node, std::string_view key, double least, double most) const;
  double positive_of(const toml::node& node, std::string_view key) const;
  std::int64_t count_of(const toml::node& node, std::string_view key, std::int64_t least,
                        std::int64_t most) const;

 private:
  std::string location(const toml::source_region& place) const;
  TomlSection member(std::string_view key, std::string_view name, const toml::node& node) const;
  const toml::node* find(std::string_view key);
  const toml::node& required(std::string_view key);

  std::string path_;
  const toml::table* table_;
  std::string name_;
  std::set<std::string, std::less<>> asked_;
};

}  // namespace podm
