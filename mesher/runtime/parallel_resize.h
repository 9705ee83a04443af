// Large vectors whose memory arrives on all threads: page faults cost four times what the zeros do.
#pragma once

#include <sys/mman.h>

#include <cstdint>
#include <vector>

#include "runtime/parallel_for.h"

namespace podm {

/// An empty vector becomes `size` zeros.
template <class T>
void parallel_resize(std::vector<T>& vector, std::size_t size, std::size_t threads) {
  constexpr std::uintptr_t kPage = 4096, kPiece = 1 << 20;
  vector.reserve(size);
  const auto address = reinterpret_cast<std::uintptr_t>(vector.data());
  const std::uintptr_t begin = (address + kPage - 1) / kPage * kPage,
                       end = std::max(begin, (address + size * sizeof(T)) / kPage * kPage);
  parallel_for_ranges(end - begin, kPiece, threads, [&](std::size_t from, std::size_t to, std::size_t) {
    // Where the kernel cannot, resize() meets the faults.
    madvise(reinterpret_cast<void*>(begin + from), to - from, MADV_POPULATE_WRITE);
  });
  vector.resize(size);
}

}  // namespace podm
