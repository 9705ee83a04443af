// The texts of --labels, --drop and --merge.
#include <algorithm>
#include <charconv>
#include <string_view>

#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {

namespace {

using Range = std::pair<std::uint32_t, std::uint32_t>;

std::uint32_t parse_value(std::string_view text, const std::string& option) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size())
    throw InputError(option + ": '" + std::string(text) +
                     "' is not a label (an integer from 0 to 4294967295)");
  return value;
}

std::vector<std::string_view> split_at_commas(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace

std::vector<Range> parse_label_ranges(const std::string& text, const std::string& option) {
  std::vector<Range> ranges;
  for (const std::string_view part : split_at_commas(text)) {
    const std::size_t dash = part.find('-');
    const std::uint32_t first = parse_value(part.substr(0, dash), option);
    const std::uint32_t last =
        dash == std::string_view::npos ? first : parse_value(part.substr(dash + 1), option);
    if (last < first) throw InputError(option + ": the range '" + std::string(part) + "' runs backwards");
    ranges.emplace_back(first, last);
  }
  return ranges;
}

LabelSelection::Merge parse_merge(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size())
    throw InputError("--merge: '" + text + "' gives no name (write it as 2,3=kidney)");
  LabelSelection::Merge merge;
  merge.name = text.substr(equals + 1);
  for (const std::string_view part : split_at_commas(std::string_view(text).substr(0, equals)))
    merge.values.push_back(parse_value(part, "--merge"));
  return merge;
}

}  // namespace podm
