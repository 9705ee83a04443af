// Components and Euler numbers of the labels of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "claims/check_surface_boundary.h"

namespace podm::verify {

struct MeshTopology {
  std::uint64_t cells = 0;
  std::uint64_t components = 0;  ///< cells connected across facets
  std::int64_t euler = 0;        ///< V - E + F - C of the cells and all their facets, edges and vertices
};

/// Collective. Returns the topology of each label, by its LabelIndex, and at kAllLabels that of all cells
/// together, except the background's. Takes about 28 bytes per cell while it runs.
std::vector<MeshTopology> find_mesh_topology(const Mesh& mesh, const Adjacency& adjacency,
                                             const CellLabelIndices& label_indices,
                                             const BoundaryFindings& boundary, int threads);

}  // namespace podm::verify
