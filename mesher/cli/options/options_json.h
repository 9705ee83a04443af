// The declared options of podm mesh and their values as data, for records and for the programs that build on
// them: podm-bench, the Python package, the documentation.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cli/options/options.h"

namespace podm::cli {

/// A JSON array with one object per option: `name`, `keyword` (in Python), `key` (in experiments and
/// records), `kind`, `choices`, `type`, `default`, `unset`, `least`, `most`, `quantity`, `group`, `help`,
/// `uses`, `not_on_ranks`, `needs`, `excludes`.
std::string options_json();

/// The key of the option in a record's `options`.
std::string record_key(const Declaration& of);

/// A value as records have it; null for labels and lists, which depend on the image.
template <class Value>
nlohmann::ordered_json json_of(const Value& value) {
  if constexpr (Named<Value>) {
    return to_string(value);
  } else if constexpr (std::same_as<Value, MemoryLimit>) {
    return value.bytes;
  } else if constexpr (std::is_arithmetic_v<Value> || std::same_as<Value, std::string> ||
                       std::same_as<Value, std::array<double, 2>>) {
    return value;
  } else {
    return nullptr;
  }
}

}  // namespace podm::cli
