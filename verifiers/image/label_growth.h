// The last step of smoothing.h: undoes the growth and shrinking of labels.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "image/image.h"
#include "image/voxel_box.h"

namespace podm::verify {

class LabelGrowth {
 public:
  /// Keeps references to the image and to the voxel weights of its voxels.
  LabelGrowth(const Image& image, const std::vector<std::uint16_t>& voxel_weights, double width_mm,
              int threads);

  /// Returns the voxel weights after this step, at least `least` where a voxel has another label among its 26
  /// neighbours. All sums are of integers, so their order does not matter. Each thread takes 16 bytes per
  /// voxel within reach of a tile.
  std::vector<std::uint16_t> without_growth(std::uint16_t least) const;

 private:
  class Table;
  using Voxel = std::array<int, 3>;
  struct Faces {
    std::int64_t area = 0, lead = 0;  // sums over faces; each lead is multiplied by the face's area
  };
  std::uint32_t label(const Voxel& v) const;
  bool is_uniform(const VoxelBox& box) const;
  bool is_at_interface(const Voxel& v) const;
  std::map<std::uint32_t, std::vector<Voxel>> at_interfaces(const VoxelBox& tile) const;
  Faces faces_of(const Voxel& v) const;
  std::uint16_t weight_without_growth(const Faces& near, std::uint16_t weight, std::uint16_t least) const;

  const Image& image_;
  const std::vector<std::uint16_t>& voxel_weights_;
  int threads_;
  VoxelBox grid_;
  std::array<int, 3> reach_{};
  std::array<std::int64_t, 3> area_{};  // of a face across each axis
};

}  // namespace podm::verify
