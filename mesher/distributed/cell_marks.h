// Marks of cells. Any number of threads may mark the same cell.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "runtime/parallel_collect.h"
#include "runtime/shared_word.h"

namespace podm {

class CellMarks {
 public:
  explicit CellMarks(CellId cell_bound) : words_((std::size_t{cell_bound} + 63) / 64) {}
  // Relaxed: marks are read after all threads have ended.
  void mark(CellId c) {
    std::uint64_t& word = words_[c / 64];
    const std::uint64_t bit = std::uint64_t{1} << c % 64;
    if ((load(word, std::memory_order_relaxed) & bit) == 0)
      std::atomic_ref(word).fetch_or(bit, std::memory_order_relaxed);
  }
  void mark_with_neighbors(CellId c, const Mesh& mesh) {
    mark(c);
    for (const FacetId mirror : mesh.cell(c).mirrors)
      if (mirror != kNoFacet) mark(cell_of(mirror));
  }
  /// Returns the marked cells in order.
  std::vector<CellId> cells(std::size_t threads) const {
    return parallel_collect<CellId>(
        words_.size(), threads, [&](std::size_t begin, std::size_t end, std::vector<CellId>& found) {
          for (std::size_t i = begin; i < end; ++i)
            for (std::uint64_t bits = words_[i]; bits != 0; bits &= bits - 1)
              found.push_back(static_cast<CellId>(64 * i + static_cast<unsigned>(std::countr_zero(bits))));
        });
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace podm
