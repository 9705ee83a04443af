// Parsing of option texts. Every function throws InputError that names the option and the fault.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "podm/choices.h"
#include "podm/errors.h"

namespace podm::cli {

/// Parses a finite number above zero; `quantity` describes it in messages, e.g. "length in mm".
double parse_positive(const std::string& text, const std::string& option, const std::string& quantity);

/// Parses an integer in [low, high]; decimal digits only.
std::uint64_t parse_integer(const std::string& text, const std::string& option, std::uint64_t low,
                            std::uint64_t high);

/// Returns "aggressive, random, global or local".
template <Named Choice>
std::string names_of_choices() {
  const auto& all = Names<Choice>::kAll;
  std::string names;
  for (std::size_t i = 0; i < all.size(); ++i)
    names += (i == 0 ? "" : i + 1 < all.size() ? ", " : " or ") + std::string(all[i].second);
  return names;
}

/// Returns "aggressive|random|global|local", the type of the option in the help, which shells complete.
template <Named Choice>
std::string type_of_choices() {
  std::string names;
  for (const auto& [value, name] : Names<Choice>::kAll) names.append(names.empty() ? "" : "|").append(name);
  return names;
}

/// Returns the choice of that name.
template <Named Choice>
Choice parse_choice(const std::string& text, const std::string& option) {
  for (const auto& [value, name] : Names<Choice>::kAll)
    if (text == name) return value;
  throw InputError(option + ": '" + text + "' is not one of " + names_of_choices<Choice>());
}

/// Parses "liver=2" or "7=0.5": a label, by name or value, and a length in mm.
std::pair<std::string, double> parse_label_length(const std::string& text, const std::string& option);

/// A bound on cells near the interface of two labels.
struct NearLabels {
  std::array<std::string, 2> labels;  ///< by name or value
  double radius_mm = 0, width_mm = 0;
};
/// Parses "liver,0=1" or "3,4=0.5:2": labels, a length in mm and a width, which defaults to that length.
NearLabels parse_near_labels(const std::string& text, const std::string& option);

/// Parses "0.5,-1,2": `count` finite numbers; `form` describes them in messages.
std::vector<double> parse_numbers(const std::string& text, const std::string& option, std::size_t count,
                                  const std::string& form);

/// Parses "2,12.5": two positive numbers; `quantity` describes them in messages.
std::pair<double, double> parse_two_positive(const std::string& text, const std::string& option,
                                             const std::string& quantity);

/// Stores the text given to the option of this name, or throws InputError.
using Setter = std::function<void(const std::string& text, const std::string& name)>;

/// The target of an option's value, and its default as the help shows it. Empty: the default is 0 or no text,
/// and the help describes it in words.
struct Target {
  template <std::convertible_to<Setter> T>
  Target(T sets, std::string shown = "") : set(std::move(sets)), default_value(std::move(shown)) {}
  Setter set;
  std::string default_value;
};

Target into(std::string& text);
Target into_length(double& length_mm);
Target into_count(std::uint64_t& count);
/// `quantity`: see parse_positive().
Target into_positive(double& value, const std::string& quantity);
Target into_threads(int& threads);
template <Named Choice>
Target into_choice(Choice& choice) {
  return {[&choice](const std::string& text, const std::string& name) {
            choice = parse_choice<Choice>(text, name);
          },
          to_string(choice)};
}

}  // namespace podm::cli
