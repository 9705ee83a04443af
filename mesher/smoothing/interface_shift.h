// Computes how far each voxel's label has grown at the voxel, on average over the interfaces nearby.
// smooth_interfaces.h subtracts this shift, so that parts of any thickness keep their volume.
//
// Between voxels of weights a and b the interface has moved outward from their face by half of a - b, in
// units of the weights. Faces count by their areas, in whole 256ths of the largest. All sums are therefore
// exact, in any order of summation.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "image/voxel.h"
#include "isosurface/voxel_weights.h"
#include "podm/label_image.h"
#include "smoothing/interface_blur.h"

namespace podm {

class InterfaceShift {
 public:
  /// Averages over everything within `reach` voxels along each axis. Keeps references to `image` and
  /// `weights`.
  InterfaceShift(const LabelImage& image, const VoxelWeights& weights, const std::array<int, 3>& reach);

  /// Scratch memory of one thread, reused from tile to tile.
  class Scratch;
  /// Shifts by place in the tile, in units of 1 / VoxelWeights::kMost, positive where the label has grown.
  /// A shift is 0 where the weight is unset, or no face is within reach. `first` is the tile's lowest voxel.
  const std::array<double, kTileVoxels>& shifts(const Voxel& first, Scratch& scratch) const;

 private:
  // A voxel with faces to other labels.
  struct Side {
    Voxel at;  // in the window
    LabelIndex label;
    double area;  // of the faces
    double lead;  // sum over the faces: area times (the voxel's weight minus the weight beyond)
  };
  using Sums = std::array<std::vector<double>, 2>;  // of areas, of leads
  std::size_t place_in_window(const Voxel& v) const;
  Side side_of(const Voxel& v, std::size_t at) const;
  void read_window(const Voxel& first, Scratch& scratch) const;
  void add_up(LabelIndex label, Scratch& scratch) const;

  const LabelImage& image_;
  const VoxelWeights& weights_;
  std::array<int, 3> reach_, window_{};   // voxels around a tile; size including them
  std::array<std::size_t, 3> stride_{};   // of the image
  std::array<double, 3> area_of_face_{};  // of the face across each axis
};

class InterfaceShift::Scratch {
 private:
  friend class InterfaceShift;
  std::vector<Side> sides;
  std::vector<LabelIndex> labels;  // labels with a weight set in the tile
  Sums sums;                       // of one label: in the window at first, in the tile at the end
  std::vector<double> along;
  std::array<double, kTileVoxels> shifts;
};

}  // namespace podm
