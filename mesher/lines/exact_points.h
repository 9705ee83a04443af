// Points that lie on the lines of an image exactly. Chords of traced arcs leave them by some hundredths of a
// voxel.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "geometry/affine.h"
#include "isosurface/voxel_weights.h"
#include "lines/block_grid.h"

namespace podm {

class ExactPoints {
 public:
  /// Keeps a reference to the image, which must hold its voxels. `weights` is null unless interfaces are
  /// smoothed.
  ExactPoints(const LabelImage& image, std::shared_ptr<const VoxelWeights> weights);

  /// The point near p where labels of the sorted set tie and no other label exceeds them: all of the set if
  /// they are at most four, otherwise the greatest three. Points are in mm. None if no such point is found
  /// within a quarter of a voxel.
  std::optional<Point> near(const Point& p, const std::vector<LabelIndex>& labels) const;

 private:
  std::optional<Point> in_block(const Voxel& block, const Point& u,
                                const std::vector<LabelIndex>& labels) const;

  std::shared_ptr<const VoxelWeights> weights_;
  BlockGrid grid_;
  Affine to_mm_, from_mm_;
};

}  // namespace podm
