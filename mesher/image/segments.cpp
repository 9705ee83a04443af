#include "image/segments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "image/number_of.h"
#include "image/raw_image.h"

namespace podm {
namespace {

// The numbers in a text; none if a word is not a number.
template <class Number>
std::vector<Number> numbers_of(const std::string& text) {
  std::vector<Number> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::optional<Number> number = number_of<Number>(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// The N of "SegmentN_...".
std::optional<std::uint32_t> number_in(std::string_view field) {
  constexpr std::string_view kPrefix = "Segment";
  if (!field.starts_with(kPrefix)) return std::nullopt;
  field.remove_prefix(kPrefix.size());
  return number_of<std::uint32_t>(field.substr(0, std::min(field.find('_'), field.size())));
}

// The fields of one segment.
class SegmentFields {
 public:
  SegmentFields(const std::string& path, const std::map<std::string, std::string>& fields,
                std::uint32_t number)
      : path_(path), fields_(fields), name_("Segment" + std::to_string(number)) {}

  const std::string* find(const std::string& key) const {
    const auto found = fields_.find(name_ + "_" + key);
    return found == fields_.end() ? nullptr : &found->second;
  }
  [[noreturn]] void refuse_field(const std::string& key, const std::string& expected) const {
    refuse(path_, name_ + "_" + key + " '" + *find(key) + "' is not " + expected);
  }

  std::string name() const {
    const std::string* const name = find("Name");
    return name != nullptr ? *name : "";
  }
  std::uint32_t value() const {
    const std::string* const text = find("LabelValue");
    if (text == nullptr) refuse(path_, name_ + " has no label value (" + name_ + "_LabelValue)");
    const auto value = numbers_of<std::uint32_t>(*text);
    if (value.size() != 1 || value[0] == 0)
      refuse_field("LabelValue", "a label (an integer from 1 to 4294967295)");
    return value[0];
  }
  std::size_t layer(std::size_t num_layers) const {
    const std::string* const text = find("Layer");
    if (text == nullptr && num_layers == 1) return 0;
    if (text == nullptr) refuse(path_, name_ + " has no layer (" + name_ + "_Layer)");
    const auto layer = numbers_of<std::size_t>(*text);
    if (layer.size() != 1 || layer[0] >= num_layers)
      refuse_field("Layer", "a layer of the file, which has " + std::to_string(num_layers));
    return layer[0];
  }
  std::optional<Rgb> colour() const {
    const std::string* const text = find("Color");
    if (text == nullptr) return std::nullopt;
    const std::vector<double> shares = numbers_of<double>(*text);
    Rgb colour{};
    bool is_colour = shares.size() == colour.size();
    for (std::size_t i = 0; is_colour && i < colour.size(); ++i) {
      is_colour = shares[i] >= 0 && shares[i] <= 1;
      if (is_colour) colour[i] = static_cast<std::uint8_t>(std::lround(255 * shares[i]));
    }
    if (!is_colour) refuse_field("Color", "three numbers from 0 to 1");
    return colour;
  }
  // The extent of a segment's voxels is not needed, but a damaged one shows a damaged header.
  void check_extent() const {
    const std::string* const text = find("Extent");
    if (text != nullptr && numbers_of<int>(*text).size() != 6) refuse_field("Extent", "six integers");
  }

 private:
  const std::string& path_;
  const std::map<std::string, std::string>& fields_;
  std::string name_;
};

void refuse_equal_values(const std::string& path, const std::vector<Segment>& segments) {
  std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> first;  // by layer and value
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto [same, is_new] = first.try_emplace({segments[i].layer, segments[i].stored_value}, i);
    if (is_new) continue;
    refuse(path, text_of_segment(segments, same->second) + " and " + text_of_segment(segments, i) +
                     " have the same label value " + std::to_string(segments[i].stored_value) + " in layer " +
                     std::to_string(segments[i].layer));
  }
}

void number_labels(std::vector<Segment>& segments) {
  std::set<std::uint32_t> values;
  for (const Segment& segment : segments) values.insert(segment.stored_value);
  const bool are_distinct = values.size() == segments.size();
  for (std::size_t i = 0; i < segments.size(); ++i)
    segments[i].label.value = are_distinct ? segments[i].stored_value : static_cast<std::uint32_t>(i + 1);
}

}  // namespace

std::vector<Segment> parse_segments(const std::string& path, const std::map<std::string, std::string>& fields,
                                    std::size_t num_layers) {
  std::set<std::uint32_t> numbers;
  for (const auto& [field, text] : fields)
    if (const auto number = number_in(field)) numbers.insert(*number);
  bool has_values = false;
  for (const std::uint32_t number : numbers) {
    const SegmentFields of(path, fields, number);
    has_values = has_values || of.find("LabelValue") != nullptr || of.find("Layer") != nullptr;
  }
  const bool is_old = !has_values && num_layers > 1 && numbers.size() == num_layers;
  std::vector<Segment> segments;
  for (const std::uint32_t number : numbers) {
    const SegmentFields of(path, fields, number);
    of.check_extent();
    const std::size_t place = segments.size();
    Segment& segment = segments.emplace_back();
    segment.label.name = of.name();
    segment.label.colour = of.colour();
    segment.stored_value = is_old ? 1 : of.value();
    segment.layer = is_old ? place : of.layer(num_layers);
  }
  refuse_equal_values(path, segments);
  number_labels(segments);
  return segments;
}

bool are_renumbered(const std::vector<Segment>& segments) {
  return std::any_of(segments.begin(), segments.end(),
                     [](const Segment& segment) { return segment.label.value != segment.stored_value; });
}

std::string text_of_segment(const std::vector<Segment>& segments, std::size_t number) {
  const std::string& name = segments[number].label.name;
  return name.empty() ? "segment " + std::to_string(number) : "segment '" + name + "'";
}

}  // namespace podm
