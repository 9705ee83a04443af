// Whether memory is where the pools say.
#pragma once

#include "delaunay/mesh.h"
#include "podm/mesh_image.h"
#include "runtime/topology.h"

namespace podm {

/// Asks the system where some pages of the store's cells are.
PageSamples sample_pages(const Mesh& mesh, const Topology& machine);

}  // namespace podm
