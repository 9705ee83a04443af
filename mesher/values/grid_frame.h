// The map from a mesh into the grid of an image, such that voxel (i,j,k) is the cube [i,i+1] x [j,j+1] x
// [k,k+1].
#pragma once

#include <array>
#include <optional>

#include "geometry/affine.h"
#include "values/exact_numbers.h"
#include "values/grid_overlap.h"

namespace podm {

/// The corners of a cell relative to the lowest corner of a voxel, accurate to a unit in the last place.
template <class Real>
struct LocalCorners {
  std::array<int, 3> origin;  ///< the voxel
  std::array<GridPoint<Real>, 4> corners;
};

class GridFrame {
 public:
  /// `grid_to_mesh` takes voxel indices, those of voxel centers, to the coordinates of the mesh. Its
  /// determinant is not 0. The grid has `parts` cubes per voxel and axis.
  GridFrame(const std::array<Rational, 12>& grid_to_mesh, int parts);

  /// Corners farther than 2^30 are moved there: all images lie between.
  LocalCorners<double> local(const std::array<std::array<double, 3>, 4>& cell) const;
  GridPoint<Rational> exact(const std::array<double, 3>& vertex) const;
  /// False if the map mirrors: positively oriented cells are then negatively oriented in the grid.
  bool keeps_orientation() const { return keeps_orientation_; }

 private:
  struct Sum {
    double high, low;
  };
  Sum map_row(std::size_t axis, const std::array<double, 3>& vertex) const;

  std::array<Rational, 12> mesh_to_grid_;
  Affine high_, low_;  // their sum is accurate to twice the precision of double
  bool keeps_orientation_;
};

/// Returns the affine as exact numbers.
std::array<Rational, 12> exact_affine(const Affine& affine);
/// Returns the inverse map. The determinant of the linear part must not be 0.
std::array<Rational, 12> exact_inverse(const std::array<Rational, 12>& affine);
/// Returns the map that applies `b` first.
std::array<Rational, 12> product(const std::array<Rational, 12>& a, const std::array<Rational, 12>& b);

}  // namespace podm
