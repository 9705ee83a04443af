// Large vectors whose memory is allocated on all threads, in huge pages where the kernel grants them: faults
// of small pages cost four times as much as writing the zeros.
#pragma once

#include <sys/mman.h>

#include <cstdint>
#include <vector>

#include "runtime/parallel_for.h"

namespace podm {

/// Grows the vector to `size` elements; new elements are zero. Reserve first if several calls follow.
template <class T>
void parallel_resize(std::vector<T>& vector, std::size_t size, std::size_t threads) {
  constexpr std::uintptr_t kPage = 4096, kPiece = 1 << 21;
  vector.reserve(size);
  const auto address = [&](std::size_t i) { return reinterpret_cast<std::uintptr_t>(vector.data() + i); };
  const std::uintptr_t begin = (address(vector.size()) + kPage - 1) / kPage * kPage,
                       end = std::max(begin, address(size) / kPage * kPage),
                       last = std::max(end, address(vector.capacity()) / kPage * kPage);
  if (last - begin >= kPiece)
    madvise(reinterpret_cast<void*>(begin), last - begin, MADV_HUGEPAGE);  // optional
  parallel_for_ranges(end - begin, kPiece, threads, [&](std::size_t from, std::size_t to, std::size_t) {
    // Where the kernel does not support this, resize() takes the faults.
    madvise(reinterpret_cast<void*>(begin + from), to - from, MADV_POPULATE_WRITE);
  });
  vector.resize(size);
}

}  // namespace podm
