// The topology of a label around a corner of voxels, where eight voxels meet.
//
// Voxel number v of the eight is up along x, y and z where bits 0, 1 and 2 of v are set. Six edges end at the
// corner: edge 2 a + u runs along axis a, up if u is 1. Four of the voxels are around it. A small sphere
// around the corner shows all of this: eight areas, twelve arcs between them, six points. The part of the
// sphere that is in the label is its *link*.
//
// An edge is ambiguous if two voxels at opposite sides of it have the label and the other two do not. If it
// joins them, it is in the label, and otherwise not. All other edges are in the label if the four voxels are.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace podm {

using VoxelMask = unsigned;  // bit v: voxel v of the eight
using EdgeMask = unsigned;   // bit e: edge e of the six
inline constexpr VoxelMask kAllVoxels = 0xff;

/// The voxels around an edge, such that each is beside the next one.
inline constexpr std::array<std::array<unsigned, 4>, 6> kVoxelsAroundEdge = [] {
  std::array<std::array<unsigned, 4>, 6> around{};
  for (unsigned e = 0; e < 6; ++e) {
    const unsigned axis = e / 2, up = (e % 2) << axis, p = 1u << (axis + 1) % 3, q = 1u << (axis + 2) % 3;
    around[e] = {up, up | p, up | p | q, up | q};
  }
  return around;
}();

/// The ambiguous edges of a label that these voxels have.
inline EdgeMask ambiguous_edges(VoxelMask label) {
  EdgeMask edges = 0;
  for (unsigned e = 0; e < 6; ++e) {
    unsigned has = 0;
    for (unsigned i = 0; i < 4; ++i) has |= (label >> kVoxelsAroundEdge[e][i] & 1) << i;
    if (has == 0b0101 || has == 0b1010) edges |= 1u << e;
  }
  return edges;
}

/// The pieces of some of the eight voxels that are joined by the faces between two of them, and by the given
/// edges.
class Pieces {
 public:
  Pieces(VoxelMask voxels, EdgeMask joining) : voxels_(voxels) {
    for (unsigned v = 0; v < 8; ++v) piece_[v] = static_cast<std::uint8_t>(v);
    for (unsigned v = 0; v < 8; ++v)
      for (unsigned axis = 0; axis < 3; ++axis) join(v, v ^ 1u << axis);
    for (unsigned e = 0; e < 6; ++e)
      if ((joining >> e & 1) != 0)
        for (unsigned i = 0; i < 2; ++i) join(kVoxelsAroundEdge[e][i], kVoxelsAroundEdge[e][i + 2]);
  }
  /// The piece of a voxel, by the number of one of its voxels.
  unsigned of(unsigned voxel) const { return piece_[voxel]; }
  unsigned count() const {
    unsigned count = 0;
    for (unsigned v = 0; v < 8; ++v) count += (voxels_ >> v & 1) != 0 && piece_[v] == v;
    return count;
  }

 private:
  void join(unsigned v, unsigned w) {
    if ((voxels_ >> v & 1) == 0 || (voxels_ >> w & 1) == 0 || piece_[v] == piece_[w]) return;
    const std::uint8_t low = piece_[v] < piece_[w] ? piece_[v] : piece_[w],
                       high = piece_[v] < piece_[w] ? piece_[w] : piece_[v];
    for (std::uint8_t& piece : piece_)
      if (piece == high) piece = low;
  }

  VoxelMask voxels_;
  std::array<std::uint8_t, 8> piece_{};
};

/// The Euler characteristic of the link. `joining` are the ambiguous edges that are in the label.
inline int euler_of_link(VoxelMask label, EdgeMask joining) {
  int euler = std::popcount(label);
  for (unsigned v = 0; v < 8; ++v)
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned w = v ^ 1u << axis;
      if (v < w && (label >> v & 1) != 0 && (label >> w & 1) != 0) --euler;
    }
  for (unsigned e = 0; e < 6; ++e) {
    unsigned has = 0;
    for (unsigned i = 0; i < 4; ++i) has += label >> kVoxelsAroundEdge[e][i] & 1;
    if (has == 4) ++euler;
    if ((joining >> e & 1) != 0) --euler;  // an arc between two areas
  }
  return euler;
}

}  // namespace podm
