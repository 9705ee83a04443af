// How far each voxel's label has grown where it lies, on average over the interfaces nearby: what
// smooth_interfaces.h takes back, so that parts of any thickness keep their volume.
//
// Between voxels of strengths a and b the interface has moved outward from their face by half of a - b, in
// the strengths' own unit. Faces count by their areas, in whole 256ths of the largest: so all sums are exact,
// in whatever order they are taken.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "image/voxel.h"
#include "isosurface/voxel_strengths.h"
#include "podm/label_image.h"
#include "smoothing/interface_blur.h"

namespace podm {

class InterfaceShift {
 public:
  /// Averages over what is within `reach` voxels along each axis. Keeps references to `image` and
  /// `strengths`.
  InterfaceShift(const LabelImage& image, const VoxelStrengths& strengths, const std::array<int, 3>& reach);

  /// What one thread works in; goes from tile to tile.
  class Desk;
  /// By place, in parts of VoxelStrengths::kMost, positive where the label has grown; 0 where no strength is
  /// told, or no face is within reach. `first` is the tile's lowest voxel.
  const std::array<double, kTileVoxels>& shifts(const Voxel& first, Desk& desk) const;

 private:
  // A voxel with faces of another label.
  struct Side {
    Voxel at;  // in the window
    LabelIndex label;
    double area;  // of the faces
    double lead;  // of the voxel's strength over those beyond, times the faces' areas
  };
  using Sums = std::array<std::vector<double>, 2>;  // of areas, of leads
  std::size_t place_in_window(const Voxel& v) const;
  Side side_of(const Voxel& v, std::size_t at) const;
  void read_window(const Voxel& first, Desk& desk) const;
  void add_up(LabelIndex label, Desk& desk) const;

  const LabelImage& image_;
  const VoxelStrengths& strengths_;
  std::array<int, 3> reach_, window_{};   // voxels around a tile, with it
  std::array<std::size_t, 3> stride_{};   // of the image
  std::array<double, 3> area_of_face_{};  // across each axis
};

class InterfaceShift::Desk {
 private:
  friend class InterfaceShift;
  std::vector<Side> sides;
  std::vector<LabelIndex> labels;  // with a strength told in the tile
  Sums sums;                       // of a label: in the window at first, in the tile at last
  std::vector<double> along;
  std::array<double, kTileVoxels> shifts;
};

}  // namespace podm
