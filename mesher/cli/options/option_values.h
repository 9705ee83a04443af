// Values of options: text, JSON. Every function that parses throws InputError with the option and the fault.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "podm/choices.h"
#include "podm/errors.h"
#include "podm/image_io.h"
#include "podm/option.h"

namespace podm::cli {

/// A finite number above zero; `quantity` says what it is, e.g. "length in mm".
double parse_positive(const std::string& text, const std::string& option, const std::string& quantity);

/// Parses an integer in [low, high]; decimal digits only.
std::uint64_t parse_integer(const std::string& text, const std::string& option, std::uint64_t low,
                            std::uint64_t high);

/// "0.5,-1,2": `count` finite numbers; `form` says what they should be.
std::vector<double> parse_numbers(const std::string& text, const std::string& option, std::size_t count,
                                  const std::string& form);

/// "aggressive, random, global or local".
template <Named Choice>
std::string names_of_choices() {
  const auto& all = Names<Choice>::kAll;
  std::string names;
  for (std::size_t i = 0; i < all.size(); ++i)
    names += (i == 0 ? "" : i + 1 < all.size() ? ", " : " or ") + std::string(all[i].second);
  return names;
}

/// Returns the choice of that name.
template <Named Choice>
Choice parse_choice(const std::string& text, const std::string& option) {
  for (const auto& [value, name] : Names<Choice>::kAll)
    if (text == name) return value;
  throw InputError(option + ": '" + text + "' is not one of " + names_of_choices<Choice>());
}

/// "aggressive|random|global|local": as help writes the values of an option, which shells complete.
template <Named Choice>
std::string type_of_choices() {
  std::string names;
  for (const auto& [value, name] : Names<Choice>::kAll) names.append(names.empty() ? "" : "|").append(name);
  return names;
}

/// A bound on cells near the interface of two labels.
struct NearLabels {
  std::array<std::string, 2> labels;  ///< by name or value
  double radius_mm = 0, width_mm = 0;
};
/// Lengths by label name or value.
using LabelLengths = std::vector<std::pair<std::string, double>>;
/// Names and paths of files.
using NamedFiles = std::vector<std::pair<std::string, std::string>>;
using LabelRanges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
using Merges = std::vector<LabelSelection::Merge>;

/// The memory that the process may take.
struct MemoryLimit {
  std::uint64_t bytes = 0;  ///< 0: kDefaultMemory
};
inline constexpr double kBytesPerGib = 1024.0 * 1024 * 1024;
/// The limit if none is given, as help shows it.
inline constexpr const char* kDefaultMemory = "80 % of the available memory";
/// The number at the start of `text`.
constexpr unsigned leading_number(const char* text) {
  unsigned number = 0;
  for (; *text >= '0' && *text <= '9'; ++text) number = 10 * number + static_cast<unsigned>(*text - '0');
  return number;
}
inline constexpr unsigned kPercentOfAvailableMemory = leading_number(kDefaultMemory);
/// A number of GiB above 0 as bytes, at least one and not more than any machine has.
std::uint64_t bytes_of_gib(double gib);

/// The time that a message takes in virtual time (distributed/in_process_ranks.h).
struct NetworkArguments {
  double latency_us = 0;
  double gigabytes_per_s = std::numeric_limits<double>::infinity();
};

/// The least and the largest value of an integer option.
std::pair<std::uint64_t, std::uint64_t> range_of_integer(const Declaration& of);

// Each stores the text given to an option; of an option that may be repeated it appends.
void parse_into(double& value, const std::string& text, const Declaration& of);
void parse_into(std::string& value, const std::string& text, const Declaration& of);
void parse_into(std::array<double, 2>& value, const std::string& text, const Declaration& of);
void parse_into(LabelLengths& value, const std::string& text, const Declaration& of);
void parse_into(std::vector<NearLabels>& value, const std::string& text, const Declaration& of);
void parse_into(NamedFiles& value, const std::string& text, const Declaration& of);
void parse_into(LabelRanges& value, const std::string& text, const Declaration& of);
void parse_into(LayerOrder& value, const std::string& text, const Declaration& of);
void parse_into(Merges& value, const std::string& text, const Declaration& of);
void parse_into(MemoryLimit& value, const std::string& text, const Declaration& of);
void parse_into(NetworkArguments& value, const std::string& text, const Declaration& of);
template <std::integral Integer>
void parse_into(Integer& value, const std::string& text, const Declaration& of) {
  const auto [low, high] = range_of_integer(of);
  value = static_cast<Integer>(parse_integer(text, spelled(of), low, high));
}
template <Named Choice>
void parse_into(Choice& value, const std::string& text, const Declaration& of) {
  value = parse_choice<Choice>(text, spelled(of));
}
template <Named Choice>
void parse_into(std::optional<Choice>& value, const std::string& text, const Declaration& of) {
  value = parse_choice<Choice>(text, spelled(of));
}

/// True for options that may be given several times.
template <class Value>
inline constexpr bool kIsRepeatable =
    std::same_as<Value, LabelLengths> || std::same_as<Value, std::vector<NearLabels>> ||
    std::same_as<Value, NamedFiles> || std::same_as<Value, Merges>;

// The default as help shows it; empty where Declaration::unset says it.
std::string shown(double value);
inline std::string shown(const std::string& value) { return value; }
std::string shown(const std::array<double, 2>& value);
template <std::integral Integer>
std::string shown(Integer value) {
  return value > 0 ? std::to_string(value) : "";
}
template <Named Choice>
std::string shown(Choice value) {
  return to_string(value);
}
template <class Other>
requires(!std::integral<Other> && !Named<Other>) std::string shown(const Other&) { return ""; }

/// Stores the text given to the option of this name, or throws InputError.
using Setter = std::function<void(const std::string& text, const std::string& name)>;

/// Stores the value of an option that is not declared beside its member, and its default as help shows it.
struct Target {
  template <std::convertible_to<Setter> T>
  Target(T sets, std::string default_text = "")
      : set(std::move(sets)), default_value(std::move(default_text)) {}
  Setter set;
  std::string default_value;
};

Target into(std::string& text);
/// Stores what parse(text, name) returns.
template <class Value, class Parse>
Target into(Value& value, Parse parse, std::string default_text = "") {
  return {[&value, parse](const std::string& text, const std::string& name) { value = parse(text, name); },
          std::move(default_text)};
}

}  // namespace podm::cli
