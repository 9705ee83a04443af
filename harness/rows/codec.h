// Writes structs that have fields() as JSON objects and reads them.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <nlohmann/json.hpp>
#include <variant>

#include "rows/fields.h"

namespace podm::bench {

template <class T>
Json to_json(const T& value) {
  return Codec<T>::write(value);
}
template <class T>
T from_json(const Json& json, const std::string& place = "") {
  return Codec<T>::read(json, place);
}

[[noreturn]] inline void fail_at(const std::string& place, const std::string& fault) {
  throw FieldError(place.empty() ? fault : fmt::format("{}: {}", place, fault));
}
inline std::string place_in(const std::string& place, const std::string& key) {
  return place.empty() ? key : fmt::format("{}/{}", place, key);
}

/// Sets the keys of `fields` in an object. Values that are equal already stay as they were written.
template <class T, class Fields>
void write_fields(const T& value, const Fields& fields, Json& into);
/// Sets the members of `fields`.
template <class T, class Fields>
void read_fields(const Json& json, const std::string& place, const Fields& fields, T& value);

template <>
struct Codec<JsonPointer> {
  static Json write(const JsonPointer& value) { return value ? *value : Json(); }
  static JsonPointer read(const Json& json, const std::string&) {
    return json.is_null() ? nullptr : std::make_shared<const Json>(json);
  }
};

// Returns what a value must be that is not of the type of `like`; empty if it is.
inline const char* must_be(const Json& json, const std::string& /*like*/) {
  return json.is_string() ? "" : "a string";
}
inline const char* must_be(const Json& json, bool /*like*/) {
  return json.is_boolean() ? "" : "true or false";
}
inline const char* must_be(const Json& json, double /*like*/) { return json.is_number() ? "" : "a number"; }
inline const char* must_be(const Json& json, int /*like*/) {
  return json.is_number_integer() ? "" : "an integer";
}
inline const char* must_be(const Json& json, std::uint64_t /*like*/) {
  const bool is_negative =
      !json.is_number_unsigned() && json.is_number_integer() && json.get<std::int64_t>() < 0;
  return json.is_number_integer() && !is_negative ? "" : "an integer that is not negative";
}
template <class T>
concept IsPlain = std::same_as<T, std::string> || std::same_as<T, bool> || std::same_as<T, double> ||
    std::same_as<T, int> || std::same_as<T, std::uint64_t>;

template <IsPlain T>
struct Codec<T> {
  static Json write(const T& value) { return value; }
  static T read(const Json& json, const std::string& place) {
    if (const std::string type = must_be(json, T()); !type.empty()) fail_at(place, "must be " + type);
    return json.get<T>();
  }
};

template <>
struct Codec<Unavailable> {
  static Json write(const Unavailable& value) { return value.text(); }
  static Unavailable read(const Json& json, const std::string& place) {
    const std::string text = json.is_string() ? json.get<std::string>() : "";
    if (!text.starts_with(Unavailable::kPrefix)) fail_at(place, "must be \"unavailable: \" and why");
    return {text.substr(std::string(Unavailable::kPrefix).size())};
  }
};

template <HasNames E>
struct Codec<E> {
  static Json write(E value) { return to_string(value); }
  static E read(const Json& json, const std::string& place) {
    const auto& names = names_of(E{});
    for (std::size_t i = 0; i < names.size(); ++i)
      if (json == names[i]) return static_cast<E>(i);
    fail_at(place, fmt::format("must be one of {}", fmt::join(names, ", ")));
  }
};

template <class T>
struct Codec<std::optional<T>> {
  static Json write(const std::optional<T>& value) { return value ? to_json(*value) : Json(); }
  static std::optional<T> read(const Json& json, const std::string& place) {
    return json.is_null() ? std::nullopt : std::optional(from_json<T>(json, place));
  }
};

template <class T>
struct Codec<std::vector<T>> {
  static Json write(const std::vector<T>& values) {
    Json json = Json::array();
    for (const T& value : values) json.push_back(to_json(value));
    return json;
  }
  static std::vector<T> read(const Json& json, const std::string& place) {
    if (!json.is_array()) fail_at(place, "must be an array");
    std::vector<T> values;
    for (const Json& member : json)
      values.push_back(from_json<T>(member, place_in(place, std::to_string(values.size()))));
    return values;
  }
};

template <class T, std::size_t size>
struct Codec<std::array<T, size>> {
  static Json write(const std::array<T, size>& values) {
    return to_json(std::vector<T>(values.begin(), values.end()));
  }
  static std::array<T, size> read(const Json& json, const std::string& place) {
    const auto members = from_json<std::vector<T>>(json, place);
    if (members.size() != size) fail_at(place, fmt::format("must have {} members", size));
    std::array<T, size> values{};
    std::copy(members.begin(), members.end(), values.begin());
    return values;
  }
};

template <class T>
struct Codec<ByName<T>> {
  static Json write(const ByName<T>& values) {
    Json json = Json::object();
    for (const auto& [name, value] : values) json[name] = to_json(value);
    return json;
  }
  static ByName<T> read(const Json& json, const std::string& place) {
    if (!json.is_object()) fail_at(place, "must be an object");
    ByName<T> values;
    for (const auto& [name, value] : json.items())
      values.emplace_back(name, from_json<T>(value, place_in(place, name)));
    return values;
  }
};

/// Reads the first alternative that fits the value.
template <class... Ts>
struct Codec<std::variant<Ts...>> {
  static Json write(const std::variant<Ts...>& value) {
    return std::visit([](const auto& held) { return to_json(held); }, value);
  }
  static std::variant<Ts...> read(const Json& json, const std::string& place) {
    std::optional<std::variant<Ts...>> value;
    std::string faults;
    (try_to_read<Ts>(json, place, value, faults), ...);
    if (!value) throw FieldError(faults);
    return *value;
  }

 private:
  template <class T>
  static void try_to_read(const Json& json, const std::string& place,
                          std::optional<std::variant<Ts...>>& value, std::string& faults) {
    if (value) return;
    try {
      value = from_json<T>(json, place);
    } catch (const FieldError& fault) {
      faults += (faults.empty() ? "" : ", or ") + std::string(fault.what());
    }
  }
};

template <HasFields T>
struct Codec<T> {
  static Json write(const T& value) {
    Json json = Json::object();
    if constexpr (CarriesOthers<T>)
      if (value.as_written) json = *value.as_written;
    write_fields(value, T::fields(), json);
    return json;
  }
  static T read(const Json& json, const std::string& place) {
    if (!json.is_object()) fail_at(place, "must be an object");
    T value{};
    if constexpr (CarriesOthers<T>) value.as_written = std::make_shared<const Json>(json);
    read_fields(json, place, T::fields(), value);
    return value;
  }
};

template <class T, class Fields>
void write_fields(const T& value, const Fields& fields, Json& into) {
  const auto write = [&](const auto& field) {
    const Json member = to_json(value.*field.member);
    const auto known = into.find(field.key);
    if (known == into.end()) {
      if (!field.may_be_absent || !member.is_null()) into[field.key] = member;
    } else if (*known != member) {
      *known = member;
    }
  };
  std::apply([&](const auto&... each) { (write(each), ...); }, fields);
}

template <class T, class Fields>
void read_fields(const Json& json, const std::string& place, const Fields& fields, T& value) {
  const auto read = [&](const auto& field) {
    using Member = std::remove_reference_t<decltype(value.*field.member)>;
    const auto known = json.find(field.key);
    if (known != json.end())
      value.*field.member = from_json<Member>(*known, place_in(place, field.key));
    else if (!field.may_be_absent)
      fail_at(place, fmt::format("has no key '{}'", field.key));
  };
  std::apply([&](const auto&... each) { (read(each), ...); }, fields);
}

}  // namespace podm::bench
