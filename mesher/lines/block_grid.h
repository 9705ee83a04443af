// The blocks of an image for which lines are traced: those of the label function, with or without a flat box.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "image/voxel.h"
#include "isosurface/voxel_weights.h"
#include "lines/lattice.h"
#include "lines/weight_forms.h"
#include "podm/label_image.h"

namespace podm {

/// Blocks (i,j,k) from -1 to the size - 1 along each axis. A block beyond the outermost voxels has corners
/// outside the grid. They are background, or with a flat box copies of the nearest voxels: only the half of
/// that block inside the image's box then counts.
class BlockGrid {
 public:
  /// Keeps references; `weights` may be null. The image must hold its voxels.
  BlockGrid(const LabelImage& image, const VoxelWeights* weights, bool is_box_flat)
      : image_(image), weights_(weights), is_box_flat_(is_box_flat) {}

  const LabelImage& image() const { return image_; }
  bool is_box_flat() const { return is_box_flat_; }
  int size(std::size_t axis) const { return image_.size[axis]; }

  BlockCorners corners(const Voxel& block) const;
  /// The part of a block that counts.
  LatticeRange range(const Voxel& block) const;
  /// The weight of the voxel nearest to v.
  std::int32_t weight(const Voxel& v) const {
    return weights_ == nullptr ? 1 : weights_->at(index_of_nearest(v));
  }
  /// The label of the voxel nearest to v.
  LabelIndex nearest_label(const Voxel& v) const { return image_.voxels[index_of_nearest(v)]; }

  /// Appends the i of all blocks (i,j,k) that have three or more labels, in ascending order. `scratch` is
  /// memory for this.
  class RowScratch;
  void find_blocks(int j, int k, RowScratch& scratch, std::vector<int>& blocks) const;

 private:
  std::size_t index_of_nearest(const Voxel& v) const {
    return image_.index(std::clamp(v.i, 0, image_.size[0] - 1), std::clamp(v.j, 0, image_.size[1] - 1),
                        std::clamp(v.k, 0, image_.size[2] - 1));
  }
  bool contains(const Voxel& v) const {
    return v.i >= 0 && v.j >= 0 && v.k >= 0 && v.i < image_.size[0] && v.j < image_.size[1] &&
           v.k < image_.size[2];
  }
  void read_row(int j, int k, LabelIndex* row) const;

  const LabelImage& image_;
  const VoxelWeights* weights_;
  bool is_box_flat_;
};

class BlockGrid::RowScratch {
 private:
  friend class BlockGrid;
  std::array<std::vector<LabelIndex>, 4> rows;
  std::vector<LabelIndex> least, greatest;
  std::vector<std::uint8_t> has_third;
};

}  // namespace podm
