// Tests if an image has a label near a point. The claims use it for the cells of a mesh that is no Delaunay
// triangulation, whose interfaces lie as far from the image's as cells are large, and for the vertices of
// facets between labels.
#pragma once

#include "image/image.h"

namespace podm::verify {

class LabelReach {
 public:
  /// The reach is `reach_mm` plus a voxel's diagonal: where the label function has a label at a point, one of
  /// the eight voxels around the point has that label.
  LabelReach(const Image& image, double reach_mm);
  double mm() const { return mm_; }
  /// True if the center of a voxel of that label lies within reach. Voxels beyond the grid are background.
  /// `point` is in voxel indices.
  bool has(std::uint32_t label, const Point& point) const;

 private:
  const Image& image_;
  double mm_;
};

}  // namespace podm::verify
