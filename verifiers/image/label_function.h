// The label function of an image: at each point the label with the greatest trilinear weight among the eight
// voxels around it, ties to the smaller label; outside the grid every voxel is background. The isosurface is
// where that label changes.
//
// A label's weight is the trilinear interpolation of its indicator (1 at its voxels, 0 elsewhere), so it is
// continuous, and along each axis it changes by at most 1 a voxel.
#pragma once

#include <array>
#include <cstdint>

#include "image/image.h"

namespace podm::verify {

/// The labels of the eight voxels around a point, each once, and their weights, which sum to 1.
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
  /// What a weight is wrong by at most, coordinates taken as they are: three factors in [0,1], each off by
  /// 2^-53, and at most eight terms.
  static constexpr double kWeightError = 0x1p-49;

  explicit LabelFunction(const Image& image);

  std::uint32_t label_at(const Point& u) const;
  LabelWeights weights_at(const Point& u) const;
  /// Derivative at u of weight(a) - weight(b), by voxel coordinates.
  Point gradient_of_difference(const Point& u, std::uint32_t a, std::uint32_t b) const;

  /// Labels of the eight voxels of the block whose first is `block`: voxel + (x,y,z) at x + 2y + 4z.
  std::array<std::uint32_t, 8> corners(const std::array<int, 3>& block) const;

 private:
  struct Place {
    std::array<int, 3> block{};
    Point f{};  // in [0,1]
  };
  bool is_near(const Point& u) const;
  static Place place(const Point& u);

  const Image& image_;
  std::size_t row_, slice_;
};

}  // namespace podm::verify
