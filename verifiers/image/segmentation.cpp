#include "image/segmentation.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

namespace podm::verify {

namespace {

using Pairs = std::map<std::string, std::string>;

// Returns true if `text` consists of exactly `count` numbers, each of which `accepts`.
template <class Number, class Accepts>
bool are_numbers(const std::string& text, std::size_t count, std::vector<Number>& numbers, Accepts accepts) {
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    Number& number = numbers.emplace_back();
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !accepts(number)) return false;
  }
  return numbers.size() == count;
}

// Returns the N of all keys "SegmentN_...".
std::set<std::uint32_t> numbers_of_segments(const Pairs& pairs) {
  const std::string prefix = "Segment";
  std::set<std::uint32_t> numbers;
  for (auto pair = pairs.lower_bound(prefix); pair != pairs.end() && pair->first.starts_with(prefix);
       ++pair) {
    const std::string& key = pair->first;
    const char* const digits = key.data() + prefix.size();
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(digits, key.data() + key.size(), number);
    if (error == std::errc() && (end == key.data() + key.size() || *end == '_')) numbers.insert(number);
  }
  return numbers;
}

// Reads the pairs of a single segment.
class SegmentReader {
 public:
  SegmentReader(const std::string& path, const Pairs& pairs, std::uint32_t number)
      : path_(path), pairs_(pairs), prefix_(fmt::format("Segment{}", number)) {}

  bool has(const char* key) const { return pairs_.contains(fmt::format("{}_{}", prefix_, key)); }

  // Returns an integer; `missing` if there is no pair.
  std::uint32_t integer(const char* key, std::uint32_t least, std::uint64_t most,
                        std::optional<std::uint32_t> missing) const {
    if (!has(key) && !missing) refuse(path_, fmt::format("{0} has no {1} ({0}_{1})", prefix_, key));
    if (!has(key)) return *missing;
    std::vector<std::uint32_t> value;
    if (!are_numbers(text(key), 1, value, [&](std::uint32_t n) { return n >= least && n <= most; }))
      refuse_text(key, fmt::format("an integer from {} to {}", least, most));
    return value[0];
  }

  // No claim is about colours and extents, but the mesher refuses a damaged header, too.
  void check_colour_and_extent() const {
    std::vector<double> colour;
    if (has("Color") && !are_numbers(text("Color"), 3, colour, [](double c) { return c >= 0 && c <= 1; }))
      refuse_text("Color", "three numbers from 0 to 1");
    std::vector<int> extent;
    if (has("Extent") && !are_numbers(text("Extent"), 6, extent, [](int) { return true; }))
      refuse_text("Extent", "six integers");
  }

 private:
  const std::string& text(const char* key) const { return pairs_.at(fmt::format("{}_{}", prefix_, key)); }
  [[noreturn]] void refuse_text(const char* key, const std::string& expected) const {
    refuse(path_, fmt::format("{}_{} is '{}', {} is expected", prefix_, key, text(key), expected));
  }

  const std::string& path_;
  const Pairs& pairs_;
  std::string prefix_;
};

// Returns a number per segment. The segment with the larger number is above.
std::vector<std::size_t> heights(const std::vector<Segment>& segments, const LabelSelection& selection) {
  const std::size_t above_all = segments.size() + selection.layers.size();
  std::vector<std::size_t> heights;
  for (const Segment& segment : segments) {
    const auto layer = std::find(selection.layers.begin(), selection.layers.end(), segment.layer);
    const std::size_t height = selection.layers.empty()
                                   ? heights.size()
                                   : static_cast<std::size_t>(layer - selection.layers.begin());
    heights.push_back(height + (keeps(selection, segment.label) ? above_all : 0));
  }
  return heights;
}

std::string place_of(const RawImage& raw, std::size_t voxel) {
  const auto x = static_cast<std::size_t>(raw.size[0]), y = static_cast<std::size_t>(raw.size[1]);
  return fmt::format("({}, {}, {})", voxel % x, voxel / x % y, voxel / x / y);
}

}  // namespace

std::vector<Segment> read_segments(const std::string& path, const Pairs& pairs, std::size_t num_layers) {
  const std::set<std::uint32_t> numbers = numbers_of_segments(pairs);
  const bool has_values = std::any_of(numbers.begin(), numbers.end(), [&](std::uint32_t number) {
    const SegmentReader segment(path, pairs, number);
    return segment.has("LabelValue") || segment.has("Layer");
  });
  const bool is_one_per_layer = !has_values && num_layers > 1 && numbers.size() == num_layers;
  std::vector<Segment> segments;
  std::set<std::uint32_t> values;
  std::set<std::pair<std::size_t, std::uint32_t>> taken;  // layers with values
  for (const std::uint32_t number : numbers) {
    const SegmentReader reader(path, pairs, number);
    std::optional<std::uint32_t> value, layer;
    if (is_one_per_layer) value = 1;
    if (is_one_per_layer) layer = static_cast<std::uint32_t>(segments.size());
    if (num_layers == 1) layer = 0;
    reader.check_colour_and_extent();
    Segment& segment = segments.emplace_back();
    segment.stored = reader.integer("LabelValue", 1, UINT32_MAX, value);
    segment.layer = reader.integer("Layer", 0, num_layers - 1, layer);
    values.insert(segment.stored);
    if (!taken.insert({segment.layer, segment.stored}).second)
      refuse(path, fmt::format("Segment{}: another segment of layer {} has its LabelValue {}", number,
                               segment.layer, segment.stored));
  }
  for (std::size_t i = 0; i < segments.size(); ++i)
    segments[i].label =
        values.size() == segments.size() ? segments[i].stored : static_cast<std::uint32_t>(i + 1);
  return segments;
}

void check_layers(const std::string& path, const RawImage& raw, const LabelSelection& selection) {
  for (const std::size_t layer : selection.layers) {
    if (raw.segments.empty())
      refuse(path, "--layers: only a segmentation of 3D Slicer has layers, and this image is none");
    if (layer >= raw.num_layers)
      refuse(path,
             fmt::format("--layers: no layer {} among {}, which are numbered from 0", layer, raw.num_layers));
  }
}

void merge_layers(RawImage& raw, const LabelSelection& selection, Image& image) {
  const std::size_t num_voxels = raw.bytes.size() / bytes_of(raw.type) / raw.num_layers;
  std::vector<std::map<std::uint32_t, std::size_t>> segments_of(raw.num_layers);  // 1 + index, by value
  for (std::size_t i = 0; i < raw.segments.size(); ++i)
    segments_of[raw.segments[i].layer][raw.segments[i].stored] = i + 1;
  const std::vector<std::size_t> height = heights(raw.segments, selection);
  std::vector<bool> is_read(raw.num_layers, selection.layers.empty());
  for (const std::size_t layer : selection.layers) is_read[layer] = true;
  std::vector<std::uint32_t> top(num_voxels);  // 1 + index
  std::size_t step = 1;                        // between the values of two layers
  for (std::size_t axis = 0; axis < std::min(raw.layer_axis, raw.size.size()); ++axis)
    step *= static_cast<std::size_t>(raw.size[axis]);
  for_each_voxel(raw, [&](std::size_t i, auto value) {
    const std::size_t layer = i / step % raw.num_layers;
    const std::size_t voxel = i / (step * raw.num_layers) * step + i % step;
    if (value == 0 || !is_read[layer]) return;
    const auto number = static_cast<double>(value);
    const bool is_integer = number > 0 && number <= UINT32_MAX && std::floor(number) == number;
    const auto found =
        is_integer ? segments_of[layer].find(static_cast<std::uint32_t>(value)) : segments_of[layer].end();
    if (found == segments_of[layer].end())
      refuse(image.path,
             fmt::format("voxel {} of layer {} is {}, which is the LabelValue of no segment there",
                         place_of(raw, voxel), layer, value));
    const std::size_t segment = found->second, other = top[voxel];
    const bool is_above = other == 0 || height[segment - 1] > height[other - 1];
    if (const std::size_t below = is_above ? other : segment; below != 0)
      image.covered_labels.insert(raw.segments[below - 1].label);
    if (is_above) top[voxel] = static_cast<std::uint32_t>(segment);
  });
  image.voxels.resize(num_voxels);
  for (std::size_t i = 0; i < num_voxels; ++i)
    image.voxels[i] = top[i] == 0 ? 0 : raw.segments[top[i] - 1].label;
}

}  // namespace podm::verify
