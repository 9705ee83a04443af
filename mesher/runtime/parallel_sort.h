// Sorting on several threads.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <iterator>

#include "runtime/parallel_for.h"

namespace podm {

/// Sorts a random-access range on at most `threads` threads: sorts runs of equal length, then merges them in
/// pairs. `less` must not throw. Equal items may take any order.
template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator first, Iterator last, std::size_t threads, const Less& less = {}) {
  constexpr std::size_t kLeastLength = 1 << 11;
  const auto size = static_cast<std::size_t>(last - first);
  const std::size_t num_runs = std::bit_floor(std::min(threads, size / kLeastLength));
  if (num_runs < 2) return std::sort(first, last, less);
  const auto begin = [&](std::size_t run) {
    return first +
           static_cast<typename std::iterator_traits<Iterator>::difference_type>(size * run / num_runs);
  };
  parallel_for(num_runs, threads,
               [&](std::size_t run, std::size_t) { std::sort(begin(run), begin(run + 1), less); });
  for (std::size_t width = 1; width < num_runs; width *= 2)
    parallel_for(num_runs / (2 * width), threads, [&](std::size_t pair, std::size_t) {
      const std::size_t run = 2 * width * pair;
      std::inplace_merge(begin(run), begin(run + width), begin(run + 2 * width), less);
    });
}

}  // namespace podm
