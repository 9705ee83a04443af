// A segmented 3-D image: one label a voxel, and where its voxels lie in the world.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace podm {

/// Position in LabelImage::labels; 0 is always the background.
using LabelIndex = std::uint16_t;
inline constexpr LabelIndex kBackground = 0;
inline constexpr std::size_t kMaxLabels = 65534;       ///< background included
inline constexpr std::size_t kMaxVoxels = 0x7fffffff;  ///< their bricks are numbered in 31 bits

struct Label {
  std::uint32_t value = 0;  ///< as stored in the image file
  std::string name;         ///< from a label table, else empty
};

/// What was dropped of a label as too small to mesh.
struct DroppedIslands {
  Label label;
  std::uint64_t number = 0;  ///< of components
  double volume_mm3 = 0;     ///< of all of them
  bool is_whole_label = false;
};

/// Voxels are stored by dense label index, x fastest. Outside the grid everything is background, so that
/// structures touching the border are closed there. The *working frame*, in which geometry is computed, is
/// the world, RAS; for an affine that shears, by more than rounding in doubles does, it is the image's own:
/// the centre of voxel (i,j,k) lies at (i*spacing[0], j*spacing[1], k*spacing[2]) mm.
struct LabelImage {
  std::array<int, 3> size{};        ///< voxels per axis
  std::array<double, 3> spacing{};  ///< mm, positive: the column norms of `voxel_to_ras`
  /// Row-major 3x4 affine from voxel indices to world mm, RAS (x right, y anterior, z superior).
  std::array<double, 12> voxel_to_ras{};
  std::vector<LabelIndex> voxels;                    ///< size[0]*size[1]*size[2]
  std::vector<Label> labels;                         ///< labels[0] is the background
  std::vector<std::string> warnings = {};            ///< what is odd about the file that it was read from
  std::vector<DroppedIslands> dropped_islands = {};  ///< by label, where any were

  std::size_t num_voxels() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(i);
  }
};

}  // namespace podm
