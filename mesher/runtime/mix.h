// A bijection of 64-bit words that spreads every bit over all bits, for hashes and pseudo-random numbers.
#pragma once

#include <cstdint>

namespace podm {

/// The finalizer of SplitMix64. (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA
/// 2014.)
constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

}  // namespace podm
