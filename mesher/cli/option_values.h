// What the text of an option means. Every function throws InputError naming the option and the fault.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

#include "podm/errors.h"
#include "podm/mesh_image.h"
#include "podm/tet_mesh.h"

namespace podm::cli {

/// A finite number above zero; `quantity` says what it should be, e.g. "length in mm".
double parse_positive(const std::string& text, const std::string& option, const std::string& quantity);

/// An integer in [low, high], decimal digits only.
std::uint64_t parse_integer(const std::string& text, const std::string& option, std::uint64_t low,
                            std::uint64_t high);

/// The choice whose to_string() is `text`.
template <class Choice>
Choice parse_choice(const std::string& text, const std::string& option,
                    std::initializer_list<Choice> choices) {
  std::string names;
  for (const Choice choice : choices) {
    if (text == to_string(choice)) return choice;
    names += (names.empty() ? "" : choice == *(choices.end() - 1) ? " or " : ", ") + to_string(choice);
  }
  throw InputError(option + ": '" + text + "' is not one of " + names);
}

/// "liver=2" or "7=0.5": a label, by name or value, and a length in mm.
std::pair<std::string, double> parse_label_length(const std::string& text, const std::string& option);

/// Stores the text given to the option of this name, or refuses it with an InputError.
using Take = std::function<void(const std::string& text, const std::string& name)>;

Take into(std::string& file_name);
Take into_length(double& length_mm);
Take into_count(std::uint64_t& count);

}  // namespace podm::cli
