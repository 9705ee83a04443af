// Points that lie on the lines of an image exactly. Chords of traced arcs leave them by some hundredths of a
// voxel.
//
// On a side of a flat box the background outside is one of a line's labels. The others tie in the plane of
// the side: two along a curve, and three where curves meet. On an edge of the box there is one fewer. In the
// blocks at a side weights do not change across it, so a search that starts in the plane stays in it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "geometry/affine.h"
#include "isosurface/box_planes.h"
#include "isosurface/voxel_weights.h"
#include "lines/block_grid.h"

namespace podm {

class ExactPoints {
 public:
  /// Keeps a reference to the image, which must hold its voxels. `weights` is null unless interfaces are
  /// smoothed.
  ExactPoints(const LabelImage& image, std::shared_ptr<const VoxelWeights> weights);

  bool is_box_flat() const { return box_.has_value(); }
  enum class On { kCurve, kNode };
  /// The point near p where labels of the sorted set tie and no other label exceeds them: all of the set if
  /// they are at most four, otherwise the greatest three; as many as said above on `sides`, those of the
  /// curve or node. The point is on on_sides(p, sides). Points are in mm. None if no such point is found
  /// within a quarter of a voxel.
  std::optional<SurfacePoint> near(const Point& p, SideMask sides, const std::vector<LabelIndex>& labels,
                                   On on) const;
  /// The point p in the planes of these sides, and in those that it nearly lies in.
  SurfacePoint on_sides(const Point& p, SideMask sides) const {
    if (!box_) return {p, sides};
    const SurfacePoint z = box_->in_planes(box_->moved_onto(sides, p));
    return {z, static_cast<SideMask>(z.sides | sides)};
  }

 private:
  struct Counts {
    std::size_t most, least;  // of labels that tie
  };
  static Counts counts_of(SideMask sides, On on);
  std::optional<Point> in_block(const Voxel& block, const Point& u, const std::vector<LabelIndex>& labels,
                                const Counts& counts) const;

  std::shared_ptr<const VoxelWeights> weights_;
  BlockGrid grid_;
  std::optional<BoxPlanes> box_;  // if it is flat
  Affine to_mm_, from_mm_;
};

}  // namespace podm
