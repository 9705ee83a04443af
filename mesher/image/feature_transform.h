// Exact Euclidean feature transform: for every voxel the nearest surface voxel, by centres, in mm.
//
// A *surface voxel* has a 6-neighbour of another label; outside the grid counts as background. One pass an
// axis: the nearest surface voxel within the x-line, then within the slice, then within the grid, each pass
// from the lower envelope of the parabolas that the previous pass left along its lines (Maurer, Qi, Raghavan,
// PAMI 25 (2003) 265-270; Felzenszwalb, Huttenlocher, Theory of Computing 8 (2012) 415-428).
//
// A surface voxel is its own feature, which leaves its word free: it tells which of the 26 voxels around have
// another label. So one or two look-ups, of a voxel and of its feature, give the shape of the isosurface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "image/oracle_reads.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

/// Which voxels around a surface voxel have another label than its own.
class Neighborhood {
 public:
  constexpr explicit Neighborhood(std::uint32_t bits) : bits_(bits) {}

  /// Bit of the voxel that is (i,j,k) away, each -1, 0 or 1.
  static constexpr unsigned position(int i, int j, int k) {
    return static_cast<unsigned>(13 + i + 3 * j + 9 * k);
  }
  constexpr bool differs(unsigned position) const { return (bits_ >> position & 1) != 0; }
  /// A bit at each position.
  constexpr std::uint32_t bits() const { return bits_; }
  /// The eight corners of the block whose lowest corner is (i,j,k) away, each -1 or 0: a bit for each that
  /// differs, corner i + 2 j + 4 k.
  constexpr unsigned differing_corners(int i, int j, int k) const {
    const std::uint32_t b = bits_ >> position(i, j, k);
    return (b & 0x3) | (b >> 1 & 0xc) | (b >> 5 & 0x30) | (b >> 6 & 0xc0);
  }
  /// Whether all that differ have one label.
  constexpr bool has_two_labels() const { return (bits_ >> 30 & 1) != 0; }

 private:
  std::uint32_t bits_;  // 27 positions; bit 30: two labels
};

/// The transform of an image, whose words lie elsewhere. `Reads` is told of each word read.
template <class Reads>
class Features {
 public:
  /// Position of a voxel in LabelImage::voxels.
  using VoxelIndex = std::uint32_t;
  /// What an image of one label has everywhere.
  static constexpr VoxelIndex kNone = 0x7fffffff;

  Features(const std::uint32_t* words, const Reads& reads) : words_(words), reads_(reads) {}

  /// The surface voxel whose centre is nearest to the centre of `voxel`.
  VoxelIndex nearest(std::size_t voxel) const {
    const std::uint32_t word = read(voxel);
    return (word & kSurface) != 0 ? static_cast<VoxelIndex>(voxel) : word;
  }
  void prefetch(std::size_t voxel) const { __builtin_prefetch(&words_[voxel]); }
  bool is_surface(std::size_t voxel) const { return (read(voxel) & kSurface) != 0; }
  /// `voxel` must be a surface voxel.
  Neighborhood neighborhood(std::size_t voxel) const { return Neighborhood(read(voxel)); }
  /// A voxel off the surface has none.
  std::optional<Neighborhood> neighborhood_if_surface(std::size_t voxel) const {
    const std::uint32_t word = read(voxel);
    return (word & kSurface) != 0 ? std::optional(Neighborhood(word)) : std::nullopt;
  }

 protected:
  static constexpr std::uint32_t kSurface = 0x80000000;  // else the word is the feature

 private:
  std::uint32_t read(std::size_t voxel) const {
    reads_.transform(voxel);
    return words_[voxel];
  }

  const std::uint32_t* words_;
  [[no_unique_address]] Reads reads_;
};

/// The words, and a look at them that nobody counts.
class FeatureTransform : private HugeArray<std::uint32_t>, public Features<NoReads> {
 public:
  /// Runs on `threads` threads (0: all cores); the result is the same for any number.
  /// Throws InputError if the image has more than kMaxVoxels.
  FeatureTransform(const LabelImage& image, int threads);

  /// One a voxel: the feature, or kSurface and the neighbourhood.
  std::span<const std::uint32_t> words() const { return {&(*this)[0], capacity()}; }
};

}  // namespace podm
