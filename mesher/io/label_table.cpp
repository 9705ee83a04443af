#include "io/label_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace podm {
namespace {

std::string printable(std::string name) {
  for (char& c : name) {
    if (c == '"') c = '\'';
    if (c == '|') c = '/';
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
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
