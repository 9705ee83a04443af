// The label function of an image: at each point the label with the greatest trilinear weight among the eight
// voxels around it, ties to the smaller label; outside the grid every voxel is background. The isosurface is
// where that label changes.
//
// A label's weight is the trilinear interpolation of its indicator: at its voxels 1, or of a smoothed image
// their strengths (smoothing.h), which are above 0 and at most 1, and 0 elsewhere. So it is continuous, and
// along each axis it changes by at most 1 a voxel. Between the centres of two voxels that share a face only
// their labels have weight, and change once.
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstdint>

#include "image/image.h"

namespace podm::verify {

/// The labels of the eight voxels around a point, each once, and their weights. These sum to 1, of a smoothed
/// image to at most 1; where there is one label it has weight 1.
struct LabelWeights {
  std::array<std::uint32_t, 8> labels{};
  std::array<double, 8> weights{};
  std::size_t count = 0;

  double weight_of(std::uint32_t label) const;
  /// Place of the greatest weight, the smaller label among equals.
  std::size_t best() const;
};

/// Points are in voxel indices. Keeps a reference to the image.
class LabelFunction {
 public:
  /// What a weight is wrong by at most, coordinates taken as they are: three factors in [0,1] and a strength,
  /// off by 2^-53 and twice that, three products and at most eight terms that sum to at most 1.
  static constexpr double kWeightError = 0x1p-49;

  /// Of the image as it is, smoothed or not.
  explicit LabelFunction(const Image& image);
  /// Of a smoothed image as it was before.
  static LabelFunction of_voxels(const Image& image);

  std::uint32_t label_at(const Point& u) const;
  /// The label at exactly this point, by rational arithmetic.
  std::uint32_t exact_label_at(const std::array<mpq_class, 3>& u) const;
  /// The same, by rational arithmetic only where rounded weights leave it open: `num_exact` counts these.
  std::uint32_t decided_label_at(const Point& u, std::uint64_t& num_exact) const;
  LabelWeights weights_at(const Point& u) const;
  /// Derivative at u of weight(a) - weight(b), by voxel coordinates.
  Point gradient_of_difference(const Point& u, std::uint32_t a, std::uint32_t b) const;

  /// Labels of the eight voxels of the block whose first is `block`: voxel + (x,y,z) at x + 2y + 4z.
  std::array<std::uint32_t, 8> corners(const std::array<int, 3>& block) const;
  /// Their strengths, in 65535ths.
  std::array<std::uint16_t, 8> strengths(const std::array<int, 3>& block) const;
  /// Where between the two voxels the label changes, if their labels differ: 0 at the first, 1 at the one
  /// after it along `axis`. One of them may lie a voxel beyond the grid.
  double change_after(const std::array<int, 3>& voxel, std::size_t axis) const;

 private:
  struct Place {
    std::array<int, 3> block{};
    Point f{};  // in [0,1]
  };
  LabelFunction(const Image& image, const Smoothing* smoothing);
  bool is_near(const Point& u) const;
  bool is_inside(const std::array<int, 3>& block) const;  // all eight voxels are in the grid
  template <class Value>
  std::array<Value, 8> eight(const std::vector<Value>& grid, const std::array<int, 3>& block) const;
  static Place place(const Point& u);
  std::uint16_t strength(const std::array<int, 3>& voxel) const;
  std::array<double, 8> smoothed(std::array<double, 8> corner_weights, const std::array<int, 3>& block) const;

  const Image& image_;
  const Smoothing* smoothing_;  // null: none
  std::size_t row_, slice_;
};

}  // namespace podm::verify
