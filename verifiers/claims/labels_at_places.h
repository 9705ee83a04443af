// The labels of a mesh at edges and corners of the image's voxels.
#pragma once

#include <vector>

#include "claims/topology_of_image.h"
#include "image/image_frame.h"
#include "mesh.h"

namespace podm::verify {

class LabelsAtPlaces {
 public:
  /// `places` are sorted by z, y, x. The label at a place is the least one of the cells that
  /// contain it, on their facets too, computed in rounded coordinates, or 0.
  LabelsAtPlaces(const Mesh& mesh, const Image& image, const ImageFrame& frame,
                 std::vector<HalfVoxel> places);

  /// 0 at a place that was not given.
  LabelValue operator()(const HalfVoxel& place) const;

 private:
  void read(const std::array<Point, 4>& cell, LabelValue label);
  std::size_t row(int y, int z) const {
    return static_cast<std::size_t>(z + 1) * static_cast<std::size_t>(rows_) +
           static_cast<std::size_t>(y + 1);
  }

  std::vector<HalfVoxel> places_;
  std::vector<LabelValue> labels_;  // by place
  std::vector<char> is_known_;
  int rows_, slices_;                  // along y and z, from -1 on
  std::vector<std::size_t> first_of_;  // place by row, and one more
};

}  // namespace podm::verify
