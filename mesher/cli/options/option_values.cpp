#include "cli/options/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "cli/options/options.h"
#include "podm/errors.h"

namespace podm::cli {
namespace {

// Parses the whole of `text` as a T; returns false on failure. Unlike strtod it ignores the locale, and it
// refuses blanks and a leading '+'.
template <class T>
bool read_all(const std::string& text, T& value) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stopped == end;
}

}  // namespace

double parse_positive(const std::string& text, const std::string& option, const std::string& quantity) {
  double value = 0;
  if (!read_all(text, value) || !std::isfinite(value) || value <= 0)
    throw InputError(fmt::format("{}: '{}' is not a positive {}", option, text, quantity));
  return value;
}

std::uint64_t parse_integer(const std::string& text, const std::string& option, std::uint64_t low,
                            std::uint64_t high) {
  std::uint64_t value = 0;
  if (!read_all(text, value) || value < low || value > high)
    throw InputError(fmt::format("{}: '{}' is not an integer from {} to {}", option, text, low, high));
  return value;
}

std::pair<std::string, double> parse_label_length(const std::string& text, const std::string& option) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("{}: '{}' is not LABEL=MM, as in liver=2 or 7=0.5", option, text));
  const std::string label = text.substr(0, equals);
  return {label, parse_positive(text.substr(equals + 1), option + " " + label, "length in mm")};
}

NearLabels parse_near_labels(const std::string& text, const std::string& option) {
  const std::size_t equals = text.rfind('='), comma = text.substr(0, equals).find(',');
  if (equals == std::string::npos || comma == std::string::npos || comma == 0 || comma + 1 == equals)
    throw InputError(fmt::format("{}: '{}' is not A,B=MM or A,B=MM:WIDTH, as in liver,0=1:3", option, text));
  const std::string labels = text.substr(0, equals);
  const std::string lengths = text.substr(equals + 1);
  const std::size_t colon = lengths.find(':');
  NearLabels near{.labels = {labels.substr(0, comma), labels.substr(comma + 1)}};
  near.radius_mm = parse_positive(lengths.substr(0, colon), option + " " + labels, "length in mm");
  near.width_mm = colon == std::string::npos
                      ? near.radius_mm
                      : parse_positive(lengths.substr(colon + 1), option + " " + labels, "width in mm");
  return near;
}

std::vector<double> parse_numbers(const std::string& text, const std::string& option, std::size_t count,
                                  const std::string& form) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (!read_all(text.substr(begin, end - begin), numbers.emplace_back()) || !std::isfinite(numbers.back()))
      numbers.resize(count + 1);  // makes the size wrong, as too many numbers do
    begin = end + 1;
  }
  if (numbers.size() != count) throw InputError(fmt::format("{}: '{}' is not {}", option, text, form));
  return numbers;
}

std::pair<double, double> parse_two_positive(const std::string& text, const std::string& option,
                                             const std::string& quantity) {
  const std::vector<double> numbers = parse_numbers(text, option, 2, quantity);
  if (numbers[0] <= 0 || numbers[1] <= 0)
    throw InputError(fmt::format("{}: '{}' is not {}", option, text, quantity));
  return {numbers[0], numbers[1]};
}

Target into(std::string& text) {
  return {[&text](const std::string& told, const std::string& name) {
            if (told.empty()) throw InputError(name + ": its value is empty");
            text = told;
          },
          text};
}

Target into_length(double& length_mm) { return into_positive(length_mm, "length in mm"); }

Target into_count(std::uint64_t& count) {
  return {[&count](const std::string& text, const std::string& name) {
            count = parse_integer(text, name, 1, std::numeric_limits<std::uint32_t>::max());
          },
          count > 0 ? std::to_string(count) : ""};
}

Target into_positive(double& value, const std::string& quantity) {
  return {[&value, quantity](const std::string& text, const std::string& name) {
            value = parse_positive(text, name, quantity);
          },
          value > 0 ? fmt::format("{:g}", value) : ""};
}

Target into_threads(int& threads) {
  return {[&threads](const std::string& text, const std::string& name) {
            threads = static_cast<int>(parse_integer(text, name, 1, kMaxThreads));
          },
          threads > 0 ? std::to_string(threads) : ""};
}

}  // namespace podm::cli
