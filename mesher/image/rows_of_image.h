// Sums over the rows of an image, on several threads.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "podm/label_image.h"
#include "runtime/parallel_for.h"

namespace podm {

/// One count per label.
struct LabelCounts {
  std::vector<std::uint64_t> of_label;
  void operator+=(const LabelCounts& b) {
    for (std::size_t label = 0; label < of_label.size(); ++label) of_label[label] += b.of_label[label];
  }
};

/// Sums over all rows along x. `count(counts, j, k)` adds one row. `none` is the sum of no rows.
template <class Counts, class Count>
Counts sum_over_rows(const LabelImage& image, int threads, const Counts& none, const Count& count) {
  struct alignas(64) OfThread {
    Counts counts;
  };
  std::vector<OfThread> sums(num_threads(threads), OfThread{none});
  parallel_for(static_cast<std::size_t>(image.size[2]), sums.size(), [&](std::size_t k, std::size_t thread) {
    for (int j = 0; j < image.size[1]; ++j) count(sums[thread].counts, j, static_cast<int>(k));
  });
  for (std::size_t t = 1; t < sums.size(); ++t) sums[0].counts += sums[t].counts;
  return std::move(sums[0].counts);
}

}  // namespace podm
