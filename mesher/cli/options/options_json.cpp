#include "cli/options/options_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/options/add_options.h"

namespace podm::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string with_underscores(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// Every mesher takes lengths in mm under keys that say so; options of podm alone have its names.
std::string experiment_key(const Declaration& of) {
  const std::string key = with_underscores(of.name);
  return of.record != nullptr && of.record == key + "_mm" ? of.record : key;
}

// Returns the key of the option in a record.
std::string record_key(const Declaration& of) {
  return of.record != nullptr ? of.record : with_underscores(of.name);
}

// A value as records have it; null for labels and lists, which depend on the image.
template <class Value>
Json json_of(const Value& value) {
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

template <class Value>
const char* kind_of(const Declaration& of) {
  if constexpr (std::same_as<Value, bool>) {
    return "flag";
  } else if constexpr (Named<Value> || std::same_as<Value, std::optional<GmshVersion>>) {
    return "choice";
  } else if constexpr (std::same_as<Value, double> || std::same_as<Value, MemoryLimit>) {
    return "real";
  } else if constexpr (std::is_integral_v<Value>) {
    return "integer";
  } else if constexpr (std::same_as<Value, std::string>) {
    const std::string type = of.type;
    return type == "FILE" || type == "MESH" || type == "PAGE" ? "file" : "text";
  } else if constexpr (std::same_as<Value, std::array<double, 2>> || std::same_as<Value, NetworkArguments>) {
    return "two reals";
  } else if constexpr (std::same_as<Value, LabelLengths>) {
    return "lengths of labels";
  } else if constexpr (std::same_as<Value, std::vector<NearLabels>>) {
    return "lengths of pairs of labels";
  } else if constexpr (std::same_as<Value, NamedFiles>) {
    return "named files";
  } else if constexpr (std::same_as<Value, LabelRanges>) {
    return "label values";
  } else if constexpr (std::same_as<Value, LayerOrder>) {
    return "integers";
  } else {
    static_assert(std::same_as<Value, Merges>);
    return "names of label values";
  }
}

template <class Value>
Json choices_of() {
  Json names = Json::array();
  if constexpr (Named<Value>) {
    for (const auto& [value, name] : Names<Value>::kAll) names.push_back(name);
  } else if constexpr (std::same_as<Value, std::optional<GmshVersion>>) {
    for (const auto& [value, name] : Names<GmshVersion>::kAll) names.push_back(name);
  }
  return names;
}

Json uses_of(unsigned uses) {
  Json names = Json::array();
  for (const auto& [use, name] :
       {std::pair{kInPodm, "podm"}, std::pair{kOnRanks, "podm-mpi"}, std::pair{kInPlan, "plan"},
        std::pair{kInPython, "python"}, std::pair{kInExperiments, "experiments"}})
    if ((uses & use) != 0) names.push_back(name);
  return names;
}

const char* or_empty(const char* text) { return text != nullptr ? text : ""; }

template <class Value>
Json object_of(const Declaration& of, const Value& value) {
  Json object = {{"name", of.name},
                 {"keyword", with_underscores(of.keyword != nullptr ? of.keyword : of.name)},
                 {"key", experiment_key(of)},
                 {"record", record_key(of)},
                 {"kind", kind_of<Value>(of)},
                 {"type", of.type},
                 {"group", title_of(of.group)},
                 {"help", of.help},
                 {"default", json_of(value)},
                 {"unset", of.unset},
                 {"quantity", of.quantity},
                 {"uses", uses_of(of.uses)},
                 {"not_on_ranks", or_empty(of.not_on_ranks)},
                 {"needs", or_empty(of.needs)},
                 {"excludes", or_empty(of.excludes)}};
  if (const Json choices = choices_of<Value>(); !choices.empty()) object["choices"] = choices;
  if constexpr (std::is_integral_v<Value> && !std::same_as<Value, bool>) {
    const auto [low, high] = range_of_integer(of);
    object["least"] = low;
    object["most"] = high;
  } else if constexpr (std::same_as<Value, double>) {
    object["least"] = of.least;
    if (std::isfinite(of.most)) object["most"] = of.most;
  }
  return object;
}

}  // namespace

std::string options_json() {
  Json all = Json::array();
  const MeshCommand command;
  for_each_option(command,
                  [&](const Declaration& of, const auto& value) { all.push_back(object_of(of, value)); });
  return all.dump(1);
}

Json option_values(const MeshCommand& command) {
  Json values = Json::object();
  for_each_option(command, [&](const Declaration& of, const auto& value) {
    if ((of.uses & kInPython) != 0 && of.group != OptionGroup::kLabels)
      values[record_key(of)] = json_of(value);
  });
  return values;
}

void add_options_command(CLI::App& program) {
  add_command(program, "options", "print the options of podm mesh as JSON, for programs");
}

}  // namespace podm::cli
