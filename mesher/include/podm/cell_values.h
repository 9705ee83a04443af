// Values of a second image on the cells of a mesh.
#pragma once

#include <cstdint>
#include <string>

#include "podm/choices.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"
#include "podm/value_image.h"

namespace podm {

struct CellValuesReport {
  double least_mean = 0, largest_mean = 0;
  std::uint64_t partly_covered = 0;  ///< cells that reach beyond the image of values
};

/// Adds four arrays to the mesh: NAME, the mean of the values over each cell, weighted by volume; NAME_least
/// and NAME_largest, of the voxels that the cell overlaps; NAME_covered, the share of the cell's volume that
/// the image of values covers. `image` is the image that was meshed. The means are exact except for 1e-12 of
/// the largest absolute value in the cell. `threads`: 0 for all cores; the result is the same for any number.
/// Throws InputError that names the file of the values, and the number of cells, if it does not cover any
/// part of some cells; the mesh then stays as it was. The mesh must have its final order of cells.
CellValuesReport add_cell_values(TetMesh& mesh, const LabelImage& image, const std::string& name,
                                 const ValueImage& values, ValuesOf of, int threads = 0);

}  // namespace podm
