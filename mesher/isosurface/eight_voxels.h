// Eight voxels that are processed together: those at the corners of a block, or their features.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "image/voxel.h"

namespace podm {

/// Eight voxels, some of which may be equal. Each register holds one number per voxel.
struct EightVoxels {
  static constexpr unsigned kNum = 8;
  using Ints [[gnu::vector_size(4 * kNum)]] = std::int32_t;
  using Numbers = std::array<std::uint32_t, kNum>;  // the numbers of a register, none negative

  Ints i, j, k;

  static EightVoxels all(const Voxel& v) { return {Ints{} + v.i, Ints{} + v.j, Ints{} + v.k}; }
  /// The corners of the box from `low` to `high`: corner a + 2 b + 4 c.
  static EightVoxels corners(const Voxel& low, const Voxel& high) {
    const auto along = [](int l, int h, const Ints& is_high) { return l + (is_high & (h - l)); };
    constexpr Ints kOdd{0, -1, 0, -1, 0, -1, 0, -1}, kUneven{0, 0, -1, -1, 0, 0, -1, -1},
        kUpper{0, 0, 0, 0, -1, -1, -1, -1};
    return {along(low.i, high.i, kOdd), along(low.j, high.j, kUneven), along(low.k, high.k, kUpper)};
  }

  Voxel operator[](unsigned c) const { return {i[c], j[c], k[c]}; }
  Numbers bricks(const BrickGrid& grid) const {
    const auto& size = grid.size();
    return numbers(((k >> 2) * size[1] + (j >> 2)) * size[0] + (i >> 2));
  }
  Numbers places_in_bricks() const { return numbers(place_in_brick(i, j, k)); }

 private:
  // Not std::bit_cast, for which compilers copy the register piece by piece.
  static Numbers numbers(const Ints& from) {
    Numbers to;
    std::memcpy(&to, &from, sizeof to);
    return to;
  }
};

}  // namespace podm
