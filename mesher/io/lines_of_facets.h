// The lines of a mesh that is given by its cells and facets alone.
#pragma once

#include "podm/tet_mesh.h"

namespace podm {

/// Returns all edges of facets along which three or more labels meet. `delta_mm` is the distance at which the
/// lines were sampled. Takes 72 bytes per facet while it runs.
MeshLines lines_of_facets(const TetMesh& mesh, double delta_mm);

}  // namespace podm
