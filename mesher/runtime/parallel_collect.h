// Lists that several threads make together.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/parallel_for.h"

namespace podm {

/// Calls collect(begin, end, list) for consecutive ranges of [0, size), on `threads` threads, and returns all
/// lists, one after the other in the order of the ranges. The result does not depend on the number of
/// threads. Throws the first exception that collect() throws.
template <class Item, class Collect>
std::vector<Item> parallel_collect(std::size_t size, std::size_t threads, const Collect& collect) {
  constexpr std::size_t kLength = 1 << 12;
  std::vector<std::vector<Item>> lists((size + kLength - 1) / kLength);
  parallel_for_ranges(size, kLength, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    collect(begin, end, lists[begin / kLength]);
  });
  std::vector<Item> all;
  std::size_t num_items = 0;
  for (const auto& list : lists) num_items += list.size();
  all.reserve(num_items);
  for (auto& list : lists) {
    all.insert(all.end(), list.begin(), list.end());
    list = {};
  }
  return all;
}

}  // namespace podm
