// Groups positions by a small integer key, by counting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace podm {

/// Positions 0..n-1 grouped by key; ascending within a group.
class Grouping {
 public:
  /// `key(i)` is the group of position i, less than `num_groups`.
  template <class Key>
  Grouping(std::size_t num_positions, std::size_t num_groups, const Key& key)
      : begin_(num_groups + 1), positions_(num_positions) {
    for (std::size_t i = 0; i < num_positions; ++i) ++begin_[key(i) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < num_positions; ++i)
      positions_[next[key(i)]++] = static_cast<std::uint32_t>(i);
  }

  std::size_t num_groups() const { return begin_.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t group) const {
    return {positions_.data() + begin_[group], begin_[group + 1] - begin_[group]};
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> positions_;
};

}  // namespace podm
