// A segmented 3-D image: one label per voxel, and the position of the voxels in the world.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace podm {

/// Position in LabelImage::labels; 0 is always the background.
using LabelIndex = std::uint16_t;
inline constexpr LabelIndex kBackground = 0;
inline constexpr std::size_t kMaxLabels = 65534;       ///< background included
inline constexpr std::size_t kMaxVoxels = 0x7fffffff;  ///< the bricks of an image are numbered in 31 bits

using Rgb = std::array<std::uint8_t, 3>;  ///< red, green, blue

struct Label {
  std::uint32_t value = 0;         ///< as stored in the image file, unless segments share stored values
  std::string name;                ///< from a label table or the image file; otherwise empty
  std::optional<Rgb> colour = {};  ///< from the same
};

/// A segment of a segmentation of 3D Slicer. A layer holds at most one segment per voxel. Segments of
/// different layers may overlap.
struct Segment {
  Label label;
  std::uint32_t stored_value = 0;  ///< in the voxels of its layer
  std::size_t layer = 0;
  std::uint64_t voxels = 0;   ///< of the segment, in the layers that are read
  std::uint64_t covered = 0;  ///< those of them that belong to a segment above it in the image
};

/// The components of a label that were dropped because they are too small to mesh.
struct DroppedIslands {
  Label label;
  std::uint64_t number = 0;  ///< number of components
  double volume_mm3 = 0;     ///< their total volume
  bool is_whole_label = false;
};

/// An image of labelled voxels, stored by dense label index, x fastest. The outside of the grid is
/// background, so structures that touch the border are closed there. Geometry is computed in the *working
/// frame*. The working frame is the world (RAS), unless the affine shears by more than rounding in doubles
/// explains, or the box is flat and its sides are oblique in the world. It is then the image's own frame: the
/// center of voxel (i,j,k) is at (i*spacing[0], j*spacing[1], k*spacing[2]) mm.
struct LabelImage {
  std::array<int, 3> size{};        ///< voxels per axis
  std::array<double, 3> spacing{};  ///< mm, positive: the column norms of `voxel_to_ras`
  /// Row-major 3x4 affine from voxel indices to world mm, RAS (x right, y anterior, z superior).
  std::array<double, 12> voxel_to_ras{};
  std::vector<LabelIndex> voxels;                    ///< size[0]*size[1]*size[2]
  std::vector<Label> labels;                         ///< labels[0] is the background
  std::vector<std::string> warnings = {};            ///< unusual properties of the file that was read
  std::vector<DroppedIslands> dropped_islands = {};  ///< one entry per label that lost components
  std::vector<Segment> segments = {};                ///< of a segmentation of 3D Slicer, in the file's order
  /// True: structures that touch the border are cut there by the planes of the outermost voxels' outer faces
  /// (MeshingOptions::box). False: their surface rounds the border's edges.
  bool is_box_flat = false;

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
