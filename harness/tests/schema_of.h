// Derives a JSON Schema from a type's fields, and compares a committed schema with it in keys, types and
// nullability. Ranges and patterns of the committed schema are not compared.
#pragma once

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

/// The part of a value's schema that fields and committed schemas share.
struct Shape {
  std::set<std::string> types;        ///< as JSON Schema calls them; empty: any
  std::set<std::string> words;        ///< the permitted texts; empty: any
  std::map<std::string, Shape> keys;  ///< of an object whose keys are known
  std::set<std::string> required;
  bool has_other_keys = false;  ///< other keys are permitted
  bool may_be_absent = false;   ///< the key may be absent, and null means the same
  std::vector<Shape>
      members;  ///< of an array, or of an object whose keys are data: one shape for all members

  void add(const Shape& other) {
    types.insert(other.types.begin(), other.types.end());
    words.insert(other.words.begin(), other.words.end());
    keys.insert(other.keys.begin(), other.keys.end());
    required.insert(other.required.begin(), other.required.end());
    has_other_keys = has_other_keys || other.has_other_keys;
    members.insert(members.end(), other.members.begin(), other.members.end());
  }
};

template <class T>
struct ShapeOf;
template <class T>
Shape shape_of() {
  return ShapeOf<T>::get();
}

inline Shape plain(const char* type) {
  Shape shape;
  shape.types = {type};
  return shape;
}

template <>
struct ShapeOf<JsonPointer> {
  static Shape get() { return {}; }
};
template <>
struct ShapeOf<std::string> {
  static Shape get() { return plain("string"); }
};
template <>
struct ShapeOf<bool> {
  static Shape get() { return plain("boolean"); }
};
template <>
struct ShapeOf<double> {
  static Shape get() { return plain("number"); }
};
template <>
struct ShapeOf<int> {
  static Shape get() { return plain("integer"); }
};
template <>
struct ShapeOf<std::uint64_t> {
  static Shape get() { return plain("integer"); }
};
template <>
struct ShapeOf<Unavailable> {
  static Shape get() { return plain("string"); }
};
template <>
struct ShapeOf<Replay> {
  static Shape get() { return plain("string"); }
};
template <HasNames E>
struct ShapeOf<E> {
  static Shape get() {
    Shape shape = plain("string");
    for (const char* name : names_of(E{})) shape.words.insert(name);
    return shape;
  }
};
template <class T>
struct ShapeOf<std::optional<T>> {
  static Shape get() {
    Shape shape = shape_of<T>();
    if (!shape.types.empty()) shape.types.insert("null");
    return shape;
  }
};
template <class T>
struct ShapeOf<std::vector<T>> {
  static Shape get() {
    Shape shape = plain("array");
    shape.members = {shape_of<T>()};
    return shape;
  }
};
template <class T, std::size_t size>
struct ShapeOf<std::array<T, size>> : ShapeOf<std::vector<T>> {};
template <class T>
struct ShapeOf<ByName<T>> {
  static Shape get() {
    Shape shape = plain("object");
    shape.members = {shape_of<T>()};
    shape.has_other_keys = true;
    return shape;
  }
};
template <class... Ts>
struct ShapeOf<std::variant<Ts...>> {
  static Shape get() {
    Shape shape;
    (shape.add(shape_of<Ts>()), ...);
    return shape;
  }
};

/// The shape of an object with these fields.
template <class Fields>
Shape shape_of_fields(const Fields& fields) {
  Shape shape = plain("object");
  const auto add = [&]<class Struct, class Member>(const Field<Struct, Member>& field) {
    Shape& member = shape.keys[field.key] = shape_of<Member>();
    member.may_be_absent = field.may_be_absent;
    if (!field.may_be_absent) shape.required.insert(field.key);
  };
  std::apply([&](const auto&... each) { (add(each), ...); }, fields);
  return shape;
}
template <HasFields T>
struct ShapeOf<T> {
  static Shape get() {
    Shape shape = shape_of_fields(T::fields());
    shape.has_other_keys = CarriesOthers<T>;
    return shape;
  }
};

/// The shape that a committed schema gives. `anyOf` states conditions and adds no types.
inline Shape shape_in(const Json& schema, const Json& root) {
  const auto name_of_type = [](const Json& value) {
    return value.is_string() ? "string" : value.is_number_integer() ? "integer" : value.type_name();
  };
  Shape shape;
  if (schema.contains("$ref"))
    shape.add(shape_in(root.at(Json::json_pointer(schema["$ref"].get<std::string>().substr(1))), root));
  for (const Json& alternative : schema.value("oneOf", Json::array())) shape.add(shape_in(alternative, root));
  const Json type = schema.value("type", Json());
  if (type.is_string()) shape.types.insert(type.get<std::string>());
  if (type.is_array())
    for (const Json& one : type) shape.types.insert(one.get<std::string>());
  if (schema.contains("const")) shape.types.insert(name_of_type(schema["const"]));
  for (const Json& word : schema.value("enum", Json::array())) {
    shape.types.insert(name_of_type(word));
    if (word.is_string()) shape.words.insert(word.get<std::string>());
  }
  const Json keys = schema.value("properties", Json::object());
  for (const auto& [key, member] : keys.items()) shape.keys[key] = shape_in(member, root);
  for (const Json& key : schema.value("required", Json::array()))
    shape.required.insert(key.get<std::string>());
  const Json others = schema.value("additionalProperties", Json());
  if (others.is_object()) shape.members.push_back(shape_in(others, root));
  shape.has_other_keys = shape.has_other_keys || (!others.is_boolean() && shape.types.contains("object"));
  if (schema.contains("items")) shape.members.push_back(shape_in(schema["items"], root));
  return shape;
}

/// Adds to `faults` each difference at `place`, "process/wall_s: ...".
inline void compare_shapes(Shape fields, Shape schema, const std::string& place,
                           std::vector<std::string>& faults) {
  if (fields.types.empty()) return;  // any value is permitted
  for (Shape* shape : {&fields, &schema}) {
    if (shape->types.contains("number")) shape->types.erase("integer");
    if (fields.may_be_absent) shape->types.erase("null");
  }
  if (fields.types != schema.types)
    faults.push_back(fmt::format("{}: fields say {}, the schema {}", place, fmt::join(fields.types, " or "),
                                 fmt::join(schema.types, " or ")));
  for (const std::string& word : schema.words)
    if (!fields.words.empty() && !fields.words.contains(word))
      faults.push_back(fmt::format("{}: no value is called {}", place, word));
  if (!fields.members.empty()) {
    if (schema.members.size() != 1)
      faults.push_back(fmt::format("{}: the schema does not list its members", place));
    else
      compare_shapes(fields.members.front(), schema.members.front(), place + "/*", faults);
    return;
  }
  for (const auto& [key, shape] : fields.keys) {
    const auto found = schema.keys.find(key);
    if (found == schema.keys.end())
      faults.push_back(fmt::format("{}: the schema has no key {}", place, key));
    else
      compare_shapes(shape, found->second, place + "/" + key, faults);
  }
  for (const auto& [key, shape] : schema.keys)
    if (!fields.has_other_keys && !fields.keys.contains(key))
      faults.push_back(fmt::format("{}: no field has the key {}", place, key));
  if (fields.required != schema.required)
    faults.push_back(fmt::format("{}: fields need {}, the schema {}", place, fmt::join(fields.required, ", "),
                                 fmt::join(schema.required, ", ")));
}

}  // namespace podm::bench
