// What the finished mesh really is, measured on its output coordinates.
#pragma once

#include "podm/mesh_image.h"
#include "refine/size_field.h"

namespace podm {

/// Fills quality, guarantees (but facet_vertices), cells and volumes by label. `mesh` is in mm. `threads`: 0
/// for all cores; the report is the same for any number, to the bit.
void measure_quality(const TetMesh& mesh, const LabelImage& image, const SizeField& sizes, int threads,
                     MeshingReport& report);

/// Labels of more than 1000 voxels without a cell.
std::uint64_t missing_labels(const LabelImage& image,
                             const std::map<std::uint32_t, std::uint64_t>& cells_of_label, int threads);

}  // namespace podm
