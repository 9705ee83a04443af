// The facets of a mesh that is given by its cells alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "podm/tet_mesh.h"

namespace podm {

/// Replaces `facets` and `facet_labels` by all faces of cells that have another label, or no cell, on their
/// other side. Cells must be positively oriented. Returns the vertices of a face that belongs to more than
/// two cells, if there is one. Takes 24 bytes per cell while it runs.
std::optional<std::array<std::uint32_t, 3>> find_labelled_facets(TetMesh& mesh);

}  // namespace podm
