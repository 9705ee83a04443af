#include "readers/item_numbers.h"

#include <fmt/format.h>

#include <algorithm>

namespace podm::verify {

void ItemNumbers::finish(const MeshFile& file, const std::string& place, const char* what) {
  if (numbers_.empty()) return;
  if (!std::is_sorted(numbers_.begin(), numbers_.end())) std::sort(numbers_.begin(), numbers_.end());
  const auto twice = std::adjacent_find(numbers_.begin(), numbers_.end(),
                                        [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice != numbers_.end()) file.refuse(place, fmt::format("{} {} is given twice", what, twice->first));
  const std::uint64_t first = numbers_.front().first, span = numbers_.back().first - first;
  if (span / 4 > numbers_.size()) return;
  table_.assign(span + 1, kNone);
  for (const auto& [number, item] : numbers_) table_[number - first] = item;
}

VertexId ItemNumbers::find(std::uint64_t number) const {
  if (numbers_.empty()) return kNone;
  if (!table_.empty()) {
    const std::uint64_t place = number - numbers_.front().first;  // wraps around for smaller numbers
    return place < table_.size() ? table_[place] : kNone;
  }
  const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), std::pair{number, VertexId{0}});
  return found != numbers_.end() && found->first == number ? found->second : kNone;
}

}  // namespace podm::verify
