// Structs that are JSON objects. A struct's fields() defines once which key holds which member. Reading,
// writing and the test of the schema use this definition.
//
//   struct Counter {
//     double value;
//     std::optional<double> running_share;
//     static constexpr auto fields() { return PODM_FIELDS(Counter, value, (running_share)); }
//   };
//
// A struct with a member `JsonPointer as_written` reads a part of an object that another program wrote. It
// keeps the whole object: keys that are not fields are written again unchanged and in their places.
//
// rows/codec.h writes and reads the structs. This header declares them without the definition of Json, which
// is long: few of the sources that use rows read or write JSON.
#pragma once

#include <boost/preprocessor.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace podm::bench {

using Json = nlohmann::ordered_json;
/// JSON as a program wrote it. Copies share it. Null: there is none.
using JsonPointer = std::shared_ptr<const Json>;

/// A fault in an object and its place: "process/wall_s: must be a number".
class FieldError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A JSON object whose keys are data, in the order in which they were written.
template <class T>
class ByName : public std::vector<std::pair<std::string, T>> {
 public:
  using std::vector<std::pair<std::string, T>>::vector;

  /// Returns null when there is no value of this name.
  const T* find(const std::string& name) const {
    for (const auto& [known, value] : *this)
      if (known == name) return &value;
    return nullptr;
  }
  /// Returns the value of this name, and creates it if absent.
  T& operator[](const std::string& name) {
    for (auto& [known, value] : *this)
      if (known == name) return value;
    return this->emplace_back(name, T{}).second;
  }
};

/// "unavailable: why", in place of a value that could not be measured.
struct Unavailable {
  static constexpr const char* kPrefix = "unavailable: ";
  std::string why;

  std::string text() const { return kPrefix + why; }
  bool operator==(const Unavailable&) const = default;
};

/// One key of an object.
template <class Struct, class Member>
struct Field {
  const char* key;
  Member Struct::*member;
  bool may_be_absent;
};

/// A key that is always present; its value is null if a std::optional is empty.
template <class Struct, class Member>
constexpr auto field(const char* key, Member Struct::*member) {
  return Field<Struct, Member>{key, member, false};
}
/// A key that is present only if the std::optional is not empty. A null is read as an absent key.
template <class Struct, class Member>
constexpr auto field_if_any(const char* key, std::optional<Member> Struct::*member) {
  return Field<Struct, std::optional<Member>>{key, member, true};
}
template <class Struct>
constexpr auto field_if_any(const char* key, JsonPointer Struct::*member) {
  return Field<Struct, JsonPointer>{key, member, true};
}

/// A std::tuple of the fields of a struct whose keys are the names of their members: `field` for each, and
/// `field_if_any` for a member in parentheses.
#define PODM_FIELDS(Struct, ...)                                                                         \
  std::tuple {                                                                                           \
    BOOST_PP_SEQ_ENUM(BOOST_PP_SEQ_TRANSFORM(PODM_FIELD, Struct, BOOST_PP_VARIADIC_TO_SEQ(__VA_ARGS__))) \
  }
#define PODM_FIELD(repetition, Struct, member)                        \
  BOOST_PP_IIF(BOOST_PP_IS_BEGIN_PARENS(member), field_if_any, field) \
  (BOOST_PP_STRINGIZE(BOOST_PP_REMOVE_PARENS(member)), &Struct::BOOST_PP_REMOVE_PARENS(member))

template <class T>
concept HasFields = requires {
  T::fields();
};
template <class T>
concept CarriesOthers = HasFields<T> && requires(T value) {
  value.as_written;
};
/// An enum whose function names_of(E) returns the texts of its values, in their order.
template <class T>
concept HasNames = requires(T value) {
  names_of(value);
};

template <HasNames E>
std::string to_string(E value) {
  return names_of(value)[static_cast<std::size_t>(value)];
}

/// Writes and reads values of a type. read() throws FieldError that names the place.
template <class T>
struct Codec;

}  // namespace podm::bench
