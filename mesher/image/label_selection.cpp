#include "image/label_selection.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <string_view>

#include "podm/errors.h"

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

// The values of a file's labels, to answer for those the user names.
class PresentValues {
 public:
  PresentValues(const std::vector<Label>& labels, std::uint32_t background, const std::string& origin)
      : background_(background), origin_(origin) {
    for (const Label& label : labels) values_.insert(label.value);
  }
  void expect_label(std::uint32_t value) const {
    if (value == background_)
      throw InputError(origin_ + ": label " + std::to_string(value) + " is the background");
    if (!values_.contains(value)) throw InputError(origin_ + ": no label " + std::to_string(value));
  }
  void expect_labels(const std::vector<Range>& ranges) const {
    for (const auto& [first, last] : ranges)
      if (first == last) expect_label(first);
  }

 private:
  std::set<std::uint32_t> values_;
  std::uint32_t background_;
  const std::string& origin_;
};

// Which label each value named by a merge goes to.
std::map<std::uint32_t, Label> merge_targets(const LabelSelection& selection, const PresentValues& present,
                                             const std::string& origin) {
  std::map<std::uint32_t, Label> targets;
  for (const LabelSelection::Merge& merge : selection.merges)
    for (const std::uint32_t value : merge.values) {
      present.expect_label(value);
      if (!targets.emplace(value, Label{merge.values.front(), merge.name}).second)
        throw InputError(origin + ": label " + std::to_string(value) + " is merged twice");
    }
  return targets;
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

void select_labels(LabelImage& image, const LabelSelection& selection, const std::string& origin) {
  const PresentValues present(image.labels, selection.background, origin);
  present.expect_labels(selection.keep);
  present.expect_labels(selection.drop);
  const auto targets = merge_targets(selection, present, origin);

  std::map<std::uint32_t, std::string> kept;  // value to name, ordered by value
  std::vector<std::uint32_t> new_value(image.labels.size(), selection.background);
  for (std::size_t i = 0; i < image.labels.size(); ++i) {
    const Label& label = image.labels[i];
    if (label.value == selection.background || covers(selection.drop, label.value) ||
        (!selection.keep.empty() && !covers(selection.keep, label.value)))
      continue;
    const auto target = targets.find(label.value);
    const Label& becomes = target == targets.end() ? label : target->second;
    new_value[i] = becomes.value;
    kept[becomes.value] = becomes.name;
  }
  if (kept.empty()) throw InputError(origin + ": no labelled voxel (all of the image is background)");

  std::map<std::uint32_t, LabelIndex> new_index{{selection.background, kBackground}};
  std::vector<Label> labels{{selection.background, {}}};
  for (const auto& [value, name] : kept) {
    if (labels.size() == kMaxLabels)
      throw InputError(origin + ": more labels than " + std::to_string(kMaxLabels));
    new_index[value] = static_cast<LabelIndex>(labels.size());
    labels.push_back({value, name});
  }
  std::vector<LabelIndex> replacement(image.labels.size());
  for (std::size_t i = 0; i < replacement.size(); ++i) replacement[i] = new_index[new_value[i]];
  for (LabelIndex& voxel : image.voxels) voxel = replacement[voxel];
  image.labels = std::move(labels);
}

}  // namespace podm
