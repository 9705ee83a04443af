// Writes numbers to a file with the most significant byte first.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "files/atomic_file.h"

namespace podm {

template <class Number>
void put_big_endian(AtomicFile& file, Number number) {
  static_assert(std::endian::native == std::endian::little && (sizeof(Number) == 4 || sizeof(Number) == 8));
  if constexpr (sizeof(Number) == 4)
    file.put(__builtin_bswap32(std::bit_cast<std::uint32_t>(number)));
  else
    file.put(__builtin_bswap64(std::bit_cast<std::uint64_t>(number)));
}

template <class Number, std::size_t N>
void put_big_endian(AtomicFile& file, const std::array<Number, N>& numbers) {
  for (const Number number : numbers) put_big_endian(file, number);
}

}  // namespace podm
