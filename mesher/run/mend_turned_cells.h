// Rounding inverts the flattest cells of a mesh that is turned for output. Their vertices move slightly.
#pragma once

#include <cstdint>

#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm {

/// Makes the cells of a mesh in RAS or LPS positively oriented that are flat or inverted. A vertex moves
/// along an axis of the image by at most 2^12 units in the last place of the largest coordinate, which is far
/// less than its distance from the isosurface. It stays within rounding of its sides of the box, and no cell
/// around it is inverted. Returns the number of such cells, also of those for which no move was found, which
/// Guarantees::orientation counts. `threads`: 0 for all cores.
std::uint64_t mend_turned_cells(TetMesh& mesh, const LabelImage& image, int threads);

}  // namespace podm
