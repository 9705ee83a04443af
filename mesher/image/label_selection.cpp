#include "image/label_selection.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <string_view>

#include "image/islands.h"
#include "image/raw_image.h"
#include "image/stretches.h"
#include "podm/errors.h"
#include "podm/option.h"
#include "runtime/parallel_for.h"

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

bool covers(const std::vector<Range>& ranges, std::uint32_t value) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [&](const Range& range) { return range.first <= value && value <= range.second; });
}

constexpr std::size_t kChunk = 1 << 18;  // voxels

std::set<std::uint32_t> values_with_voxels(const LabelImage& image, std::size_t threads) {
  std::vector<std::vector<char>> is_used(threads, std::vector<char>(image.labels.size()));
  parallel_for_ranges(image.voxels.size(), kChunk, threads,
                      [&](std::size_t begin, std::size_t end, std::size_t thread) {
                        char* const used = is_used[thread].data();
                        const LabelIndex* const voxels = image.voxels.data();
                        for_each_stretch(voxels, sizeof(LabelIndex), begin, end,
                                         [&](std::size_t from, std::size_t to, bool is_uniform) {
                                           const std::size_t last = is_uniform ? from + 1 : to;
                                           for (std::size_t i = from; i < last; ++i) used[voxels[i]] = true;
                                         });
                      });
  std::set<std::uint32_t> values;
  for (const std::vector<char>& used : is_used)
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i]) values.insert(image.labels[i].value);
  return values;
}

void replace_voxels(std::vector<LabelIndex>& voxels, const std::vector<LabelIndex>& replacement,
                    std::size_t threads) {
  bool is_identity = true;
  for (std::size_t i = 0; i < replacement.size(); ++i) is_identity = is_identity && replacement[i] == i;
  if (is_identity) return;
  parallel_for_ranges(voxels.size(), kChunk, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) voxels[i] = replacement[voxels[i]];
  });
}

// The final label of each value that the image has and the selection keeps. The background's value is not
// among them.
class SelectedLabels {
 public:
  SelectedLabels(const LabelImage& image, const LabelSelection& selection, const std::string& path,
                 const std::set<std::uint32_t>& present)
      : path_(path), background_(selection.background), present_(present) {
    for (const Segment& segment : image.segments)
      if (segment.covered > 0) covered_.insert(segment.label.value);
    expect_labels(selection.keep, spelled("labels", "keep"));
    expect_labels(selection.drop, spelled("drop"));
    std::set<std::uint32_t> merged;
    for (const LabelSelection::Merge& merge : selection.merges)
      for (const std::uint32_t value : merge.values) {
        expect_label(value, spelled("merge"));
        if (!merged.insert(value).second)
          refuse(path, spelled("merge") + ": label " + std::to_string(value) + " is merged twice");
      }
    for (const Label& label : image.labels)
      if (present_.contains(label.value) && label.value != background_ && is_kept(selection, label.value))
        becomes_[label.value] = label;
    for (const LabelSelection::Merge& merge : selection.merges) {
      const auto first = becomes_.find(merge.values.front());
      const auto colour = first == becomes_.end() ? std::nullopt : first->second.colour;
      for (const std::uint32_t value : merge.values)
        if (const auto kept = becomes_.find(value); kept != becomes_.end())
          kept->second = {merge.values.front(), merge.name, colour};
    }
  }

  const std::map<std::uint32_t, Label>& by_value() const { return becomes_; }

 private:
  void expect_label(std::uint32_t value, const std::string& option) const {
    const std::string label = option + ": label " + std::to_string(value);
    if (value == background_) refuse(path_, label + " is the background");
    if (!present_.contains(value) && !covered_.contains(value)) refuse(path_, label + " is not in the image");
  }
  void expect_labels(const std::vector<Range>& ranges, const std::string& option) const {
    for (const auto& [first, last] : ranges)
      if (first == last) expect_label(first, option);
  }

  const std::string& path_;
  std::uint32_t background_;
  const std::set<std::uint32_t>& present_;
  std::set<std::uint32_t> covered_;  // by other segments, perhaps entirely
  std::map<std::uint32_t, Label> becomes_;
};

// Gives the labels, the segments and the background the names and colours of a table.
void take_names(LabelImage& image, const LabelSelection& selection) {
  const auto is_background = [&](const Label& label) { return label.value == selection.background; };
  if (std::none_of(image.labels.begin(), image.labels.end(), is_background))
    image.labels.push_back({selection.background, {}});
  std::map<std::uint32_t, const Label*> entries;
  for (const Label& entry : selection.table) entries[entry.value] = &entry;
  const auto take = [&](Label& label) {
    const auto found = entries.find(label.value);
    if (found == entries.end()) return;
    label.name = found->second->name;
    if (found->second->colour) label.colour = found->second->colour;
  };
  for (Label& label : image.labels) take(label);
  for (Segment& segment : image.segments) take(segment.label);
}

}  // namespace

bool is_kept(const LabelSelection& selection, std::uint32_t value) {
  return value == selection.background ||
         (!covers(selection.drop, value) && (selection.keep.empty() || covers(selection.keep, value)));
}

std::vector<Range> parse_label_ranges(const std::string& text, const std::string& option) {
  std::vector<Range> ranges;
  for (const std::string_view part : split_at_commas(text)) {
    const std::size_t dash = part.find('-');
    const std::uint32_t first = parse_value(part.substr(0, dash), option);
    const std::uint32_t last =
        dash == std::string_view::npos ? first : parse_value(part.substr(dash + 1), option);
    if (last < first)
      throw InputError(option + ": the range '" + std::string(part) + "' has its ends in the wrong order");
    ranges.emplace_back(first, last);
  }
  return ranges;
}

LayerOrder parse_layers(const std::string& text, const std::string& option) {
  LayerOrder layers;
  for (const std::string_view part : split_at_commas(text)) {
    std::size_t layer = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), layer);
    if (error != std::errc{} || end != part.data() + part.size())
      throw InputError(option + ": '" + std::string(part) + "' is not a layer (an integer from 0)");
    if (std::find(layers.begin(), layers.end(), layer) != layers.end())
      throw InputError(option + ": layer " + std::to_string(layer) + " is given twice");
    layers.push_back(layer);
  }
  return layers;
}

LabelSelection::Merge parse_merge(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size())
    throw InputError(spelled("merge") + ": '" + text + "' has no name (write it as 2,3=kidney)");
  LabelSelection::Merge merge;
  merge.name = text.substr(equals + 1);
  for (const std::string_view part : split_at_commas(std::string_view(text).substr(0, equals)))
    merge.values.push_back(parse_value(part, spelled("merge")));
  return merge;
}

std::vector<LabelIndex> select_among(LabelImage& image, const LabelSelection& selection,
                                     const std::set<std::uint32_t>& present, const std::string& path) {
  take_names(image, selection);
  const SelectedLabels selected(image, selection, path, present);
  std::map<std::uint32_t, Label> final_labels;  // by value
  for (const auto& [value, label] : selected.by_value()) final_labels[label.value] = label;
  if (final_labels.empty()) refuse(path, "no foreground: every voxel is background or deselected");
  if (final_labels.size() >= kMaxLabels)
    refuse(path, "a label image is needed: more than " + std::to_string(kMaxLabels - 1) + " labels");

  std::vector<Label> labels{*std::find_if(image.labels.begin(), image.labels.end(), [&](const Label& label) {
    return label.value == selection.background;
  })};
  std::map<std::uint32_t, LabelIndex> new_index;
  for (const auto& [value, label] : final_labels) {
    new_index[value] = static_cast<LabelIndex>(labels.size());
    labels.push_back(label);
  }
  std::vector<LabelIndex> replacement(image.labels.size(), kBackground);
  for (std::size_t i = 0; i < replacement.size(); ++i)
    if (const auto label = selected.by_value().find(image.labels[i].value);
        label != selected.by_value().end())
      replacement[i] = new_index.at(label->second.value);
  image.labels = std::move(labels);
  return replacement;
}

void select_labels(LabelImage& image, const LabelSelection& selection, const std::string& path,
                   std::size_t threads) {
  const std::set<std::uint32_t> present = values_with_voxels(image, threads);
  replace_voxels(image.voxels, select_among(image, selection, present, path), threads);
  if (selection.drop_islands_mm3 != 0) drop_islands(image, selection.drop_islands_mm3, path);
}

}  // namespace podm
