// The last step of smoothing.h: by how much a label has grown near a voxel, and strengths without that.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "image/image.h"
#include "image/voxel_box.h"

namespace podm::verify {

class LabelGrowth {
 public:
  /// Keeps references to the image and to the strengths of its voxels.
  LabelGrowth(const Image& image, const std::vector<std::uint16_t>& strengths, double width_mm, int threads);

  /// The strengths, no less than `least` where a voxel has another label among its 26 neighbours. All sums
  /// are of integers, so that no order of theirs matters. Takes 16 bytes a voxel within reach of a tile, a
  /// thread.
  std::vector<std::uint16_t> taken_back(std::uint16_t least) const;

 private:
  class Table;
  using Voxel = std::array<int, 3>;
  struct Faces {
    std::int64_t area = 0, lead = 0;  // of all; each lead times the face's area
  };
  std::uint32_t label(const Voxel& v) const;
  bool is_uniform(const VoxelBox& box) const;
  bool is_at_interface(const Voxel& v) const;
  std::map<std::uint32_t, std::vector<Voxel>> at_interfaces(const VoxelBox& tile) const;
  Faces faces_of(const Voxel& v) const;
  std::uint16_t strength_without(const Faces& near, std::uint16_t strength, std::uint16_t least) const;

  const Image& image_;
  const std::vector<std::uint16_t>& strengths_;
  int threads_;
  VoxelBox grid_;
  std::array<int, 3> reach_{};
  std::array<std::int64_t, 3> area_{};  // of a face across each axis
};

}  // namespace podm::verify
