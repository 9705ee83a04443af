// Makes the table and the words of a feature transform.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/image_by_bricks.h"
#include "isosurface/brick_features.h"
#include "isosurface/surface_masks.h"
#include "podm/label_image.h"
#include "runtime/huge_array.h"

namespace podm {

/// The layout of a near brick in words of 8 bytes: first the words of its voxels, then the mask of surface
/// voxels and their neighborhoods.
struct LayoutOfBrick {
  static constexpr std::size_t kWordsOfLine = 8;
  static constexpr std::size_t kMaskAt = 16, kMostLines = 7;
  static constexpr std::size_t in_lines(std::size_t words) {
    return (words + kWordsOfLine - 1) / kWordsOfLine;
  }
  static constexpr std::size_t lines_of(std::uint64_t mask) {
    const auto num_surface = static_cast<std::size_t>(std::popcount(mask));
    return in_lines(num_surface == 0 ? kMaskAt : kMaskAt + 1 + (num_surface + 1) / 2);
  }
};

/// Works on one row of bricks at a time.
class FeatureWriter {
 public:
  /// One thread's scratch memory, by brick of a row.
  struct Scratch {
    std::vector<std::uint64_t> any, around;
  };

  /// Keeps the references. If the voxels stay in the image's file, the masks need only be nonzero where they
  /// are.
  FeatureWriter(const LabelImage& image, const BrickGrid& bricks, const SurfaceMasks& masks,
                const Surroundings& surroundings);

  std::size_t num_rows() const { return bricks_.count() / row_; }
  std::vector<Scratch> scratch_for(std::size_t threads) const;
  std::size_t count_lines(std::size_t row, Scratch& scratch) const;
  /// Writes into the table, as doubles, 0 for bricks with surface voxels and their neighbors, and infinity
  /// for all other bricks.
  void mark_beside_surface(std::size_t row, HugeArray<std::uint64_t>& words, Scratch& scratch) const;
  /// Replaces the squared distances in the table by its final entries. The words of this row's bricks begin
  /// at `line`; near bricks are unread if the voxels stay in the image's file.
  void write(std::size_t row, std::size_t line, double step_mm, HugeArray<std::uint64_t>& words,
             Scratch& scratch) const;
  /// Writes the words of a near brick with this mask.
  void write_words(const Voxel& brick, std::uint64_t mask, std::uint64_t* to) const;

 private:
  Voxel at(std::size_t row, int i) const;
  const std::vector<std::uint64_t>& surface_around(std::size_t row, const std::array<int, 3>& num_bricks,
                                                   Scratch& scratch) const;
  LabelIndex label_of(std::size_t index, const Voxel& brick) const;

  const LabelImage& image_;
  const ImageByBricks* in_file_;  // null if the image holds its voxels
  const BrickGrid& bricks_;
  const SurfaceMasks& masks_;
  const Surroundings& surroundings_;
  BrickFeatures features_;
  std::size_t row_;  // bricks
};

}  // namespace podm
