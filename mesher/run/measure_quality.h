// What the finished mesh really is, measured on its output coordinates.
#pragma once

#include <vector>

#include "podm/mesh_image.h"
#include "sizing/size_field.h"

namespace podm {

/// Fills quality, guarantees (but facet_vertices), cells and volumes by label. `mesh` is in mm. `threads`: 0
/// for all cores; the report is the same for any number, to the bit.
void measure_quality(const TetMesh& mesh, const LabelImage& image, const SizeField& sizes, int threads,
                     MeshingReport& report);

/// Of every cell, in the units of the mesh's space.
struct CellQualities {
  std::vector<double> radius_edge, circumradius, min_dihedral_deg, max_dihedral_deg, volume;
};
/// `threads`: 0 for all cores.
CellQualities qualities_of_cells(const TetMesh& mesh, int threads = 0);

/// Labels of more than 1000 voxels without a cell.
std::uint64_t missing_labels(const LabelImage& image,
                             const std::map<std::uint32_t, std::uint64_t>& cells_of_label, int threads);

}  // namespace podm
