// Numbers in the text of headers and tables.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace podm {

/// Returns the number that the whole text is. Unlike strtod it ignores the locale.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace podm
