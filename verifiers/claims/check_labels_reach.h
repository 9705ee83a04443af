// Whether an image has a label near a point: what is asked of the cells of a mesh that is no Delaunay
// triangulation, whose interfaces lie as far from the image's as cells are large; and of the vertices of
// facets between labels.
#pragma once

#include <array>

#include "image/image.h"

namespace podm::verify {

class LabelReach {
 public:
  /// `reach_mm` and a voxel's diagonal: where the label function has a label at a point, one of the eight
  /// voxels around it has that label.
  LabelReach(const Image& image, double reach_mm);
  double mm() const { return mm_; }
  /// Whether the centre of a voxel of that label lies within reach, those beyond the grid being background's;
  /// `point` is in voxel indices.
  bool has(std::uint32_t label, const Point& point) const;

 private:
  const Image& image_;
  double mm_;
};

}  // namespace podm::verify
