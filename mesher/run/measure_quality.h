// Measures the finished mesh on its output coordinates.
#pragma once

#include <vector>

#include "podm/mesh_image.h"
#include "sizing/size_field.h"

namespace podm {

/// Fills the quality, the guarantees (except facet_vertices), and the cells and volumes by label. `mesh` is
/// in mm. `threads`: 0 for all cores; the report is bitwise the same for any number.
void measure_quality(const TetMesh& mesh, const LabelImage& image, const SizeField& sizes, int threads,
                     MeshingReport& report);

/// Qualities of every cell, in the units of the mesh's space.
struct CellQualities {
  std::vector<double> radius_edge, circumradius, min_dihedral_deg, max_dihedral_deg, volume;
};
/// `threads`: 0 for all cores.
CellQualities qualities_of_cells(const TetMesh& mesh, int threads = 0);

/// The number of labels of more than 1000 voxels without a cell.
std::uint64_t missing_labels(const LabelImage& image,
                             const std::map<std::uint32_t, std::uint64_t>& cells_of_label, int threads);

}  // namespace podm
