// The values of a second image on the cells of a mesh.
#pragma once

#include <vector>

#include "podm/choices.h"
#include "podm/tet_mesh.h"
#include "podm/value_image.h"
#include "values/grid_frame.h"

namespace podm {

/// The values of an image over the part of a cell that the image covers.
struct CellValue {
  double mean = 0;     ///< weighted by volume
  double least = 0;    ///< of the voxels that have more than 1e-12 of the cell
  double largest = 0;  ///< likewise
  double covered_share =
      0;  ///< of the cell's volume; 0: the image does not cover the cell, and has no values
  double covered_voxels = 0;  ///< covered volume, in voxels
};

/// Returns the value of each cell. `grid_to_mesh` takes voxel indices of `values` to the coordinates of the
/// mesh. The means have an error of at most 1e-12 of the largest absolute value in the cell: where a bound on
/// the rounding errors of doubles exceeds this, more precise and finally rational numbers are used.
/// `threads`: 0 for all cores; the result is the same for any number.
std::vector<CellValue> values_of_cells(const TetMesh& mesh, const ValueImage& values,
                                       const std::array<Rational, 12>& grid_to_mesh, ValuesOf of,
                                       int threads);

}  // namespace podm
