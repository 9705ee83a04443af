#include "image/label_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "errors.h"
#include "image/islands.h"
#include "image/raw_image.h"

namespace podm::verify {

namespace {

template <class Visit>
void for_each_part(std::string_view text, const Visit& visit) {
  std::size_t comma = 0;
  while ((comma = text.find(',')) != std::string_view::npos) {
    visit(text.substr(0, comma));
    text.remove_prefix(comma + 1);
  }
  visit(text);
}

bool holds(const LabelSelection::Ranges& ranges, std::uint32_t value) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [value](const auto& range) { return range.first <= value && value <= range.second; });
}

/// Swaps 0 and a background of another value.
template <class Value>
Value with_background_moved(Value value, Value background) {
  return value == background ? 0 : value == 0 ? background : value;
}

void expect_foreground(const Image& image, const std::set<std::uint32_t>& present,
                       const LabelSelection& selection, std::uint32_t value, const char* option) {
  if (value == selection.background)
    refuse(image.path, fmt::format("{}: label {} is the background", option, value));
  if (!present.contains(value)) refuse(image.path, fmt::format("{}: no voxel has label {}", option, value));
}

void check_selection(const Image& image, const std::set<std::uint32_t>& present,
                     const LabelSelection& selection) {
  // A range may include values without voxels. A single value without voxels is taken for a typing error.
  for (const auto& [first, last] : selection.keep)
    if (first == last) expect_foreground(image, present, selection, first, "--labels");
  for (const auto& [first, last] : selection.drop)
    if (first == last) expect_foreground(image, present, selection, first, "--drop");
  std::set<std::uint32_t> merged;
  for (const auto& values : selection.merges) {
    for (const std::uint32_t value : values) {
      expect_foreground(image, present, selection, value, "--merge");
      if (!merged.insert(value).second)
        refuse(image.path, fmt::format("--merge: label {} is merged twice", value));
    }
  }
}

}  // namespace

std::uint32_t parse_label(std::string_view text, const std::string& option) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw InputError(fmt::format("{}: '{}' is not a label (an integer, 0 to 2^32-1)", option, text));
  return value;
}

LabelSelection::Ranges parse_label_ranges(const std::string& text, const std::string& option) {
  LabelSelection::Ranges ranges;
  for_each_part(text, [&](std::string_view part) {
    const std::size_t dash = std::min(part.find('-'), part.size());
    const std::uint32_t first = parse_label(part.substr(0, dash), option);
    const std::uint32_t last = dash == part.size() ? first : parse_label(part.substr(dash + 1), option);
    if (last < first) throw InputError(fmt::format("{}: the range '{}' runs backwards", option, part));
    ranges.emplace_back(first, last);
  });
  return ranges;
}

std::vector<std::size_t> parse_layers(const std::string& text, const std::string& option) {
  std::vector<std::size_t> layers;
  for_each_part(text, [&](std::string_view part) {
    std::size_t layer = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), layer);
    if (error != std::errc() || end != part.data() + part.size())
      throw InputError(fmt::format("{}: '{}' is not the number of a layer", option, part));
    if (std::find(layers.begin(), layers.end(), layer) != layers.end())
      throw InputError(fmt::format("{}: layer {} is named twice", option, layer));
    layers.push_back(layer);
  });
  return layers;
}

std::vector<std::uint32_t> parse_merge(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size())
    throw InputError(fmt::format("--merge: '{}' is not VALUES=NAME, as in 2,3=kidney", text));
  std::vector<std::uint32_t> values;
  for_each_part(std::string_view(text).substr(0, equals),
                [&](std::string_view part) { values.push_back(parse_label(part, "--merge")); });
  return values;
}

bool keeps(const LabelSelection& selection, std::uint32_t value) {
  return value == selection.background ||
         (!holds(selection.drop, value) && (selection.keep.empty() || holds(selection.keep, value)));
}

void select_labels(Image& image, const LabelSelection& selection) {
  const std::set<std::uint32_t> present(image.voxels.begin(), image.voxels.end());
  std::set<std::uint32_t> known = present;
  known.insert(image.covered_labels.begin(), image.covered_labels.end());
  check_selection(image, known, selection);
  std::map<std::uint32_t, std::uint32_t> becomes;
  for (const std::uint32_t value : present)
    if (value != selection.background && keeps(selection, value)) becomes[value] = value;
  for (const auto& values : selection.merges)
    for (const std::uint32_t value : values)
      if (becomes.contains(value)) becomes[value] = values.front();
  if (becomes.empty()) refuse(image.path, "no voxel has a label that is selected");
  for (std::uint32_t& voxel : image.voxels) {
    const auto found = becomes.find(voxel);
    voxel = found == becomes.end() ? selection.background : found->second;
  }
  if (selection.drop_islands_mm3 > 0) drop_islands(image, selection.background, selection.drop_islands_mm3);
  for (std::uint32_t& voxel : image.voxels) voxel = with_background_moved(voxel, selection.background);
}

void move_background(Mesh& mesh, std::uint32_t background) {
  const auto moved = [&](LabelValue label) { return with_background_moved<LabelValue>(label, background); };
  for (LabelValue& label : mesh.cell_labels) label = moved(label);
  for (auto& labels : mesh.facet_labels)
    for (LabelValue& label : labels) label = moved(label);
  std::map<LabelValue, std::string> names;
  for (const auto& [label, name] : mesh.label_names) names[moved(label)] = name;
  mesh.label_names = std::move(names);
}

}  // namespace podm::verify
