// The label function of an image. At each point it is the label with the greatest trilinear weight among the
// eight voxels around the point; ties go to the smaller label. Outside the grid every voxel is background.
// The isosurface is where the label changes.
//
// With a flat box the label at a point between the outer faces of the outermost voxels is that of the nearest
// point between their centers: these voxels go on up to their faces. Outside the faces the label is
// background.
//
// A label's weight is the trilinear interpolation of its indicator. The indicator is 1 at the label's voxels
// and 0 elsewhere. In a smoothed image it is the weight of the voxel (smoothing.h), above 0 and at most
// 1, in place of 1. The weight is therefore continuous, and along each axis it changes by at most 1 per
// voxel. Between the centers of two voxels that share a face only their labels have weight, and the label
// changes once.
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstdint>

#include "image/image.h"

namespace podm::verify {

/// The labels of the eight voxels around a point, each once, and their weights. The weights sum to 1, in a
/// smoothed image to at most 1. If there is only one label, its weight is 1.
struct LabelWeights {
  std::array<std::uint32_t, 8> labels{};
  std::array<double, 8> weights{};
  std::size_t count = 0;

  double weight_of(std::uint32_t label) const;
  /// Returns the position of the greatest weight; the smaller label wins a tie.
  std::size_t best() const;
};

/// Points are in voxel indices. Keeps a reference to the image.
class LabelFunction {
 public:
  /// Error bound of a weight, for coordinates taken as they are. It adds up three factors in [0,1] and a
  /// voxel weight, off by 2^-53 and twice that, three products, and at most eight terms that sum to at
  /// most 1.
  static constexpr double kWeightError = 0x1p-49;

  /// The function of the image as it is, smoothed or not.
  explicit LabelFunction(const Image& image);
  /// The function of a smoothed image before it was smoothed.
  static LabelFunction of_voxels(const Image& image);

  std::uint32_t label_at(const Point& u) const;
  /// Returns the label at exactly this point, by rational arithmetic.
  std::uint32_t exact_label_at(const std::array<mpq_class, 3>& u) const;
  /// Returns the same label. It uses rational arithmetic only where rounded weights leave the label open;
  /// `num_exact` counts these points.
  std::uint32_t decided_label_at(const Point& u, std::uint64_t& num_exact) const;
  LabelWeights weights_at(const Point& u) const;
  /// True if the box is flat and u is outside.
  bool is_outside_box(const Point& u) const { return image_.is_box_flat && !is_near(u); }
  /// True if the box is flat and u is within `reach` of the plane of one of its sides, where weights jump.
  bool is_at_side(const Point& u, double reach) const;
  /// Returns the derivative at u of weight(a) - weight(b), by voxel coordinates.
  Point gradient_of_difference(const Point& u, std::uint32_t a, std::uint32_t b) const;

  /// Returns the labels of the eight voxels of the block whose first is `block`: voxel + (x,y,z) at x + 2y +
  /// 4z.
  std::array<std::uint32_t, 8> corners(const std::array<int, 3>& block) const;
  /// Returns the weights of these voxels, in 65535ths.
  std::array<std::uint16_t, 8> voxel_weights(const std::array<int, 3>& block) const;
  /// Returns where the label changes between `voxel` (0) and the next voxel along `axis` (1), if their labels
  /// differ. One of the two may lie one voxel beyond the grid.
  double change_after(const std::array<int, 3>& voxel, std::size_t axis) const;

 private:
  struct Place {
    std::array<int, 3> block{};
    Point f{};  // in [0,1]
  };
  LabelFunction(const Image& image, const Smoothing* smoothing);
  bool is_near(const Point& u) const;
  Point in_grid(const Point& u) const;
  bool is_inside(const std::array<int, 3>& block) const;  // all eight voxels are in the grid
  template <class Value>
  std::array<Value, 8> eight(const std::vector<Value>& grid, const std::array<int, 3>& block) const;
  static Place place(const Point& u);
  std::uint16_t voxel_weight(const std::array<int, 3>& voxel) const;
  std::array<double, 8> smoothed(std::array<double, 8> corner_weights, const std::array<int, 3>& block) const;

  const Image& image_;
  const Smoothing* smoothing_;  // null: none
  std::size_t row_, slice_;
};

}  // namespace podm::verify
