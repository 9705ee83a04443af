#include "io/label_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>

namespace podm {
namespace {

// Returns true if `text` is UTF-8; characters beyond ASCII must be allowed in XML.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    if (lead < 0xc2 || lead > 0xf4) return false;
    const int num_following = lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
    std::uint32_t character = lead & (0x3f >> num_following);
    for (int n = 0; n < num_following; ++n, ++i) {
      if (i == text.size() || (text[i] & 0xc0) != 0x80) return false;
      character = character << 6 | (text[i] & 0x3f);
    }
    // A shorter form exists for smaller values.
    constexpr std::array<std::uint32_t, 4> kSmallest{0, 0x80, 0x800, 0x10000};
    if (character < kSmallest[num_following] || character > 0x10ffff) return false;
    if ((character >= 0xd800 && character < 0xe000) || (character & 0xfffe) == 0xfffe) return false;
  }
  return true;
}

std::string printable(std::string name) {
  const bool keep_beyond_ascii = is_utf8(name);
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"') c = '\'';
    if (c == '|') c = '/';
    if (byte < ' ' || byte == 0x7f) c = ' ';
    if (byte >= 0x80 && !keep_beyond_ascii) c = '?';
  }
  return name;
}

}  // namespace

LabelNames::LabelNames(const std::vector<Label>& labels) {
  std::set<std::string> taken;
  for (const Label& label : labels) {
    std::string name = names_.empty()       ? "outside"
                       : label.name.empty() ? fmt::format("label {}", label.value)
                                            : printable(label.name);
    while (!taken.insert(name).second) name += fmt::format(" {}", label.value);
    names_.push_back(std::move(name));
  }
}

std::string LabelNames::of_pair(const LabelPair& pair) const {
  return names_[pair[1]] + "|" + names_[pair[0]];
}

std::string LabelNames::of_line(const std::vector<LabelIndex>& labels) const {
  std::string text;
  for (const LabelIndex label : labels)
    if (label != kBackground) text += names_[label] + "|";
  if (!labels.empty() && labels.front() == kBackground) return text + names_[kBackground];
  return text.substr(0, text.size() - 1);
}

std::vector<std::array<std::uint32_t, 4>> colours_of(const std::vector<Label>& labels) {
  std::vector<std::array<std::uint32_t, 4>> colours;
  for (std::size_t i = 1; i < labels.size(); ++i)
    if (const auto& colour = labels[i].colour)
      colours.push_back({labels[i].value, (*colour)[0], (*colour)[1], (*colour)[2]});
  return colours;
}

LabelPairs::LabelPairs(const std::vector<LabelPair>& facet_labels) {
  for (const LabelPair& pair : facet_labels)
    if (pairs_.empty() || pairs_.back() != pair) pairs_.push_back(pair);
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
}

std::size_t LabelPairs::number_of(const LabelPair& pair) const {
  return static_cast<std::size_t>(std::lower_bound(pairs_.begin(), pairs_.end(), pair) - pairs_.begin());
}

}  // namespace podm
