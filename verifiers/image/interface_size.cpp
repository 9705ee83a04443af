#include "image/interface_size.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "errors.h"
#include "image/label_selection.h"

namespace podm::verify {

namespace {

constexpr const char* kOption = "--size-near";

[[noreturn]] void refuse_text(std::string_view text) {
  throw InputError(fmt::format("{}: '{}' is not A,B=MM or A,B=MM:WIDTH, label values and mm, as in 3,0=1:3",
                               kOption, text));
}

double parse_length(std::string_view length, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(length.data(), length.data() + length.size(), value);
  if (error != std::errc{} || end != length.data() + length.size()) refuse_text(text);
  if (!(value > 0) || std::isinf(value))
    throw InputError(fmt::format("{} {}: '{}' is not a positive, finite length", kOption, text, length));
  return value;
}

std::vector<std::uint32_t> parse_side(std::string_view side, std::string_view text) {
  std::vector<std::uint32_t> labels;
  const std::string option = fmt::format("{} {}", kOption, text);
  for (std::size_t plus = 0; (plus = side.find('+')) != std::string_view::npos; side.remove_prefix(plus + 1))
    labels.push_back(parse_label(side.substr(0, plus), option));
  labels.push_back(parse_label(side, option));
  return labels;
}

}  // namespace

InterfaceSize parse_interface_size(const std::string& text) {
  const std::string_view all = text;
  const std::size_t equals = all.find('='), comma = all.substr(0, equals).find(',');
  if (equals == std::string_view::npos || comma == std::string_view::npos) refuse_text(text);
  const std::string_view lengths = all.substr(equals + 1);
  const std::size_t colon = lengths.find(':');
  InterfaceSize near{.text = text,
                     .labels = {parse_side(all.substr(0, comma), text),
                                parse_side(all.substr(comma + 1, equals - comma - 1), text)}};
  near.radius_mm = parse_length(lengths.substr(0, colon), text);
  near.width_mm =
      colon == std::string_view::npos ? near.radius_mm : parse_length(lengths.substr(colon + 1), text);
  return near;
}

}  // namespace podm::verify
