// How options are declared with CLI11: one line each, text in, a checked value stored.
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <string>
#include <vector>

#include "cli/option_values.h"
#include "cli/options.h"
#include "podm/errors.h"

namespace podm::cli {

// An option taking one value, given once or, when `many`, any number of times; `take(text, name)` stores it.
template <class Take>
CLI::Option* add_value(CLI::App& app, const std::string& names, const std::string& type, bool many,
                       const std::string& description, Take take) {
  const std::string name = names.substr(names.rfind(',') + 1);
  auto take_all = [take, name](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) take(text, name);
  };
  CLI::Option* option = app.add_option_function<std::vector<std::string>>(names, take_all, description);
  option->type_name(type)->type_size(1)->allow_extra_args(false);
  if (!many) option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  return option;
}

template <class Take>
CLI::Option* add_one(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& description, Take take) {
  return add_value(app, names, type, false, description, take);
}

template <class Take>
CLI::Option* add_many(CLI::App& app, const std::string& names, const std::string& type,
                      const std::string& description, Take take) {
  return add_value(app, names, type, true, description, take);
}

inline auto into(std::string& target) {
  return [&target](const std::string& text, const std::string& name) {
    if (text.empty()) throw InputError(name + ": the name of a file is empty");
    target = text;
  };
}

inline auto into_length(double& target_mm) {
  return [&target_mm](const std::string& text, const std::string& name) {
    target_mm = parse_positive(text, name, "length in mm");
  };
}

inline auto into_count(std::uint64_t& target) {
  return [&target](const std::string& text, const std::string& name) {
    target = parse_integer(text, name, 1, std::numeric_limits<std::uint32_t>::max());
  };
}

/// IMAGE and what is kept of its labels.
void add_image_options(CLI::App& app, ImageArguments& image);
void add_mesh_command(CLI::App& program, MeshCommand& command);

}  // namespace podm::cli
