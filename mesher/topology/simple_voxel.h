// Simple voxels: those that can enter or leave a set of voxels without a change of its topology.
//
// Faces join the voxels of the set, and faces, edges and corners those of the rest. A voxel is simple if its
// 26 neighbors have exactly one piece of the set among its 18 nearest that is beside the voxel, and exactly
// one piece of the rest. (Bertrand, Malandain, "A new characterization of three-dimensional simple points",
// 1994.)
#pragma once

#include <array>
#include <cstdint>

namespace podm {

/// Bit 9 (dk + 1) + 3 (dj + 1) + di + 1: the neighbor (di, dj, dk) away is in the set. Bit 13 is ignored.
using Around27 = std::uint32_t;

namespace simple_voxel {

inline constexpr Around27 kAll = 0x7ffffff, kMiddle = 1u << 13;

/// The neighbors of each of the 27 by faces, and those by faces, edges and corners.
inline constexpr auto kNeighbors = [] {
  std::array<std::array<Around27, 27>, 2> neighbors{};
  for (int a = 0; a < 27; ++a)
    for (int b = 0; b < 27; ++b) {
      const int di = a % 3 - b % 3, dj = a / 3 % 3 - b / 3 % 3, dk = a / 9 - b / 9;
      const int far = di * di + dj * dj + dk * dk;
      const bool is_near = di * di <= 1 && dj * dj <= 1 && dk * dk <= 1;
      if (far == 1) neighbors[0][static_cast<unsigned>(a)] |= 1u << b;
      if (a != b && is_near) neighbors[1][static_cast<unsigned>(a)] |= 1u << b;
    }
  return neighbors;
}();
/// The 6 and the 18 nearest of the middle.
inline constexpr Around27 kSix = kNeighbors[0][13];
inline constexpr Around27 kEighteen = [] {
  Around27 eighteen = 0;
  for (int a = 0; a < 27; ++a) {
    const int di = a % 3 - 1, dj = a / 3 % 3 - 1, dk = a / 9 - 1, far = di * di + dj * dj + dk * dk;
    if (far == 1 || far == 2) eighteen |= 1u << a;
  }
  return eighteen;
}();

/// The number of pieces of `set` that have a member of `beside`, up to 2.
inline int num_pieces(Around27 set, Around27 beside, const std::array<Around27, 27>& neighbors) {
  int pieces = 0;
  for (Around27 left = set & beside; left != 0 && pieces < 2; ++pieces) {
    Around27 piece = left & (~left + 1), front = piece;
    while (front != 0) {
      const auto at = static_cast<unsigned>(__builtin_ctz(front));
      front &= front - 1;
      const Around27 next = neighbors[at] & set & ~piece;
      piece |= next;
      front |= next;
    }
    left &= ~piece;
  }
  return pieces;
}

}  // namespace simple_voxel

inline bool is_simple(Around27 set) {
  using namespace simple_voxel;
  return num_pieces(set & kEighteen, kSix, kNeighbors[0]) == 1 &&
         num_pieces(kAll & ~set & ~kMiddle, kAll, kNeighbors[1]) == 1;
}

}  // namespace podm
