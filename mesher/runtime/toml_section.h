// A table of a TOML file, read key by key. An unexpected or invalid entry is refused with its place.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace podm {

/// A TOML file with an invalid entry; what() is "file:line:column: fault".
class TomlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A value of a TOML file. Every member function throws TomlError if the value is not as requested.
struct TomlValue {
  struct Array {
    std::vector<TomlValue> members;
  };
  struct Table {
    std::vector<TomlValue> entries;  ///< in the order of the file
  };

  struct Place {
    int line = 0, column = 0;
    auto operator<=>(const Place&) const = default;
  };

  std::string path;  ///< of the file
  std::string key;   ///< a member of an array has the key of the array
  Place key_place, place;
  /// A date or a time is a std::monostate.
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Table> content;

  /// Returns null if the value has another type.
  template <class Type>
  const Type* as() const {
    return std::get_if<Type>(&content);
  }
  /// Returns "file:line:column".
  std::string where(Place at) const;
  [[noreturn]] void fail(const std::string& fault) const;

  /// The text must not be empty.
  std::string text() const;
  bool flag() const;
  /// A number may be an integer and must be finite.
  double number() const;
  double number(double least, double most) const;
  double positive() const;
  std::int64_t count(std::int64_t least, std::int64_t most) const;
};

/// Returns the file's table. Throws TomlError if the file does not exist or is not valid TOML.
TomlValue parse_toml(const std::string& path);
/// Also refuses non-ASCII characters: in keys they lead toml++ 3.3 into undefined behaviour.
TomlValue parse_ascii_toml(const std::string& path);
/// Parses the text of the file `path`.
TomlValue parse_toml_text(const std::string& text, const std::string& path);

/// Every member throws TomlError "file:line:column: fault". The table must outlive the section. The
/// constructor throws if the value is no table.
class TomlSection {
 public:
  TomlSection(const TomlValue& table, std::string name);

  /// Reports a fault of the whole table, or of the value at `key` if the table has one.
  [[noreturn]] void fail(const std::string& fault) const { table_->fail(fault); }
  [[noreturn]] void fail(std::string_view key, const std::string& fault) const {
    (has(key) ? get(key) : table_)->fail(fault);
  }
  /// Returns "file:line:column" of the value at `key`, which must exist.
  std::string where(std::string_view key) const { return get(key)->where(get(key)->place); }
  bool has(std::string_view key) const { return get(key) != nullptr; }
  bool is_array(std::string_view key) const { return as<TomlValue::Array>(key) != nullptr; }
  bool is_table(std::string_view key) const { return as<TomlValue::Table>(key) != nullptr; }
  bool is_text(std::string_view key, std::string_view text) const {
    const auto* const found = as<std::string>(key);
    return found != nullptr && *found == text;
  }

  /// The text must not be empty. The second function returns `otherwise` if the key is absent.
  std::string text(std::string_view key) { return required(key).text(); }
  std::string text(std::string_view key, const std::string& otherwise) {
    return find(key) == nullptr ? otherwise : text(key);
  }
  bool flag(std::string_view key) { return find(key) != nullptr && required(key).flag(); }
  double positive(std::string_view key, double otherwise) {
    return find(key) == nullptr ? otherwise : required(key).positive();
  }
  /// The value must be from `least` to `most`. The second function returns `otherwise` if the key is absent.
  double number(std::string_view key, double least, double most) { return required(key).number(least, most); }
  double number(std::string_view key, double otherwise, double least, double most) {
    return find(key) == nullptr ? otherwise : number(key, least, most);
  }
  /// Returns any number; nothing if the key is absent.
  std::optional<double> number(std::string_view key) {
    return find(key) == nullptr ? std::nullopt : std::optional(required(key).number());
  }
  std::int64_t count(std::string_view key, std::int64_t least, std::int64_t most) {
    return required(key).count(least, most);
  }
  std::int64_t count(std::string_view key, std::int64_t otherwise, std::int64_t least, std::int64_t most) {
    return find(key) == nullptr ? otherwise : count(key, least, most);
  }
  /// Returns the members of an array, or the single value; empty if the key is absent. Refuses an empty
  /// array.
  std::vector<TomlValue> values(std::string_view key);
  /// Returns the table at `key`, which must exist.
  TomlSection table(std::string_view key) { return {required(key), std::string(key)}; }
  /// Returns the table at `key`; an empty one if it is absent.
  TomlSection optional_table(std::string_view key);
  /// Returns the keys in the order of the file; each counts as read.
  std::vector<std::string> keys();
  /// Returns the tables [key.NAME], in the order of the file.
  std::vector<std::pair<std::string, TomlSection>> tables(std::string_view key);
  /// Returns the tables [[key]], in the order of the file.
  std::vector<TomlSection> table_array(std::string_view key);
  /// Refuses keys that were not read.
  void done() const;

 private:
  const TomlValue* get(std::string_view key) const;
  template <class Type>
  const Type* as(std::string_view key) const {
    const TomlValue* const value = get(key);
    return value == nullptr ? nullptr : value->as<Type>();
  }
  const TomlValue* find(std::string_view key);
  const TomlValue& required(std::string_view key);

  const TomlValue* table_;
  const std::vector<TomlValue>* entries_;
  std::string name_;
  std::set<std::string, std::less<>> asked_;
};

}  // namespace podm
