#include "cli/options/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <tuple>

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

std::vector<double> parse_numbers(const std::string& text, const std::string& option, std::size_t count,
                                  const std::string& form) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (!read_all(text.substr(begin, end - begin), numbers.emplace_back()) || !std::isfinite(numbers.back()))
      numbers.resize(count + 1);  // of no use, as too many are
    begin = end + 1;
  }
  if (numbers.size() != count) throw InputError(fmt::format("{}: '{}' is not {}", option, text, form));
  return numbers;
}

namespace {

const std::string& not_empty(const std::string& text, const std::string& option) {
  if (text.empty()) throw InputError(option + ": its value is empty");
  return text;
}

std::pair<double, double> two_positive(const std::string& text, const std::string& option,
                                       const std::string& form) {
  const std::vector<double> numbers = parse_numbers(text, option, 2, form);
  if (numbers[0] <= 0 || numbers[1] <= 0)
    throw InputError(fmt::format("{}: '{}' is not {}", option, text, form));
  return {numbers[0], numbers[1]};
}

// "liver=2" or "7=0.5".
std::pair<std::string, double> label_length(const std::string& text, const std::string& option) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("{}: '{}' is not LABEL=MM, as in liver=2 or 7=0.5", option, text));
  const std::string label = text.substr(0, equals);
  return {label, parse_positive(text.substr(equals + 1), option + " " + label, "length in mm")};
}

// "liver,0=1" or "3,4=0.5:2"; the width is the length unless it is given.
NearLabels near_labels(const std::string& text, const std::string& option) {
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

// "HU=ct.nii.gz".
std::pair<std::string, std::string> named_file(const std::string& text, const std::string& option) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw InputError(fmt::format("{}: '{}' is not NAME=FILE, as in HU=ct.nii.gz", option, text));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace

std::uint64_t bytes_of_gib(double gib) {
  constexpr double kMost = 1e18;  // far above any machine, and within an integer
  return static_cast<std::uint64_t>(std::clamp(gib * kBytesPerGib, 1.0, kMost));
}

std::pair<std::uint64_t, std::uint64_t> range_of_integer(const Declaration& of) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return {of.least == 0 ? 0 : 1, std::isinf(of.most) ? kMost : static_cast<std::uint64_t>(of.most)};
}

void parse_into(double& value, const std::string& text, const Declaration& of) {
  const double parsed = parse_positive(text, spelled(of), of.quantity);
  if (!is_in_range(parsed, of))
    throw InputError(fmt::format("{}: '{}' is not a {}", spelled(of), text, range_text(of)));
  value = parsed;
}

void parse_into(std::string& value, const std::string& text, const Declaration& of) {
  value = not_empty(text, spelled(of));
}

void parse_into(std::array<double, 2>& value, const std::string& text, const Declaration& of) {
  std::tie(value[0], value[1]) = two_positive(text, spelled(of), "MIN,MAX, as in 8,165");
}

void parse_into(LabelLengths& value, const std::string& text, const Declaration& of) {
  value.push_back(label_length(text, spelled(of)));
}

void parse_into(NamedFiles& value, const std::string& text, const Declaration& of) {
  value.push_back(named_file(text, spelled(of)));
}

void parse_into(std::vector<NearLabels>& value, const std::string& text, const Declaration& of) {
  value.push_back(near_labels(text, spelled(of)));
}

void parse_into(LabelRanges& value, const std::string& text, const Declaration& of) {
  value = parse_label_ranges(text, spelled(of));
}

void parse_into(LayerOrder& value, const std::string& text, const Declaration& of) {
  value = parse_layers(text, spelled(of));
}

void parse_into(Merges& value, const std::string& text, const Declaration&) {
  value.push_back(parse_merge(text));
}

void parse_into(MemoryLimit& value, const std::string& text, const Declaration& of) {
  value.bytes = bytes_of_gib(parse_positive(text, spelled(of), of.quantity));
}

void parse_into(NetworkArguments& value, const std::string& text, const Declaration& of) {
  std::tie(value.latency_us, value.gigabytes_per_s) =
      two_positive(text, spelled(of), "US,GB/S, as in 2,12.5");
}

std::string shown(double value) { return value > 0 ? fmt::format("{:g}", value) : ""; }

std::string shown(const std::array<double, 2>& value) { return fmt::format("{:g},{:g}", value[0], value[1]); }

Target into(std::string& text) {
  return {[&text](const std::string& given, const std::string& name) { text = not_empty(given, name); },
          text};
}

}  // namespace podm::cli
