// Morton codes: the bits of three coordinates interleaved, x lowest. A cube whose side is a power of two that
// divides its corner owns consecutive codes. Dropping three bits of a code gives the enclosing cube of twice
// the side.
#pragma once

#include <array>
#include <cstdint>

namespace podm {

using GridPoint = std::array<std::uint32_t, 3>;
using MortonCode = std::uint64_t;

inline constexpr unsigned kMortonBits = 21;  // bits per coordinate

inline MortonCode morton_code(const GridPoint& p) {
  const auto spread = [](std::uint64_t x) {  // two zeros between any two bits
    x = (x | x << 32) & 0x001f00000000ffffu;
    x = (x | x << 16) & 0x001f0000ff0000ffu;
    x = (x | x << 8) & 0x100f00f00f00f00fu;
    x = (x | x << 4) & 0x10c30c30c30c30c3u;
    return (x | x << 2) & 0x1249249249249249u;
  };
  return spread(p[0]) | spread(p[1]) << 1 | spread(p[2]) << 2;
}

inline GridPoint morton_point(MortonCode code) {
  const auto gather = [](std::uint64_t x) {
    x &= 0x1249249249249249u;
    x = (x | x >> 2) & 0x10c30c30c30c30c3u;
    x = (x | x >> 4) & 0x100f00f00f00f00fu;
    x = (x | x >> 8) & 0x001f0000ff0000ffu;
    x = (x | x >> 16) & 0x001f00000000ffffu;
    return static_cast<std::uint32_t>(x | x >> 32) & ((1u << kMortonBits) - 1);
  };
  return {gather(code), gather(code >> 1), gather(code >> 2)};
}

}  // namespace podm
