// The labels around a surface voxel, compared with its own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace podm {

/// The edges from a voxel to its six neighbors: edge 2 a leads down the axis a, and edge 2 a + 1 up.
inline constexpr unsigned kNumEdges = 6;
constexpr std::size_t axis_of(unsigned edge) { return edge >> 1; }
constexpr bool leads_up(unsigned edge) { return (edge & 1) != 0; }

/// The set of the voxels around a surface voxel that have another label than its own.
class Neighborhood {
 public:
  constexpr explicit Neighborhood(std::uint32_t bits) : bits_(bits) {}

  /// The bit of the voxel that is (i,j,k) away, each -1, 0 or 1.
  static constexpr unsigned position(int i, int j, int k) {
    return static_cast<unsigned>(13 + i + 3 * j + 9 * k);
  }
  /// One bit for each position.
  constexpr std::uint32_t bits() const { return bits_; }
  /// The differing corners of the block whose lowest corner is (i,j,k) away, each -1 or 0. The bit of corner
  /// i + 2 j + 4 k is set if the corner differs.
  constexpr unsigned differing_corners(int i, int j, int k) const {
    const std::uint32_t b = bits_ >> position(i, j, k);
    return (b & 0x3) | (b >> 1 & 0xc) | (b >> 5 & 0x30) | (b >> 6 & 0xc0);
  }
  /// The edges that change the label, one bit per edge.
  constexpr unsigned changing_edges() const {
    constexpr std::array<unsigned, kNumEdges> kNeighbors{position(-1, 0, 0), position(1, 0, 0),
                                                         position(0, -1, 0), position(0, 1, 0),
                                                         position(0, 0, -1), position(0, 0, 1)};
    unsigned edges = 0;
    for (unsigned e = 0; e < kNumEdges; ++e) edges |= (bits_ >> kNeighbors[e] & 1) << e;
    return edges;
  }
  /// True if all voxels that differ have one label.
  constexpr bool has_two_labels() const { return (bits_ >> 30 & 1) != 0; }

 private:
  std::uint32_t bits_;  // 27 positions; bit 30: two labels
};

}  // namespace podm
