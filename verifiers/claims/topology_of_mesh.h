// The components of the labels of a mesh, with the handles and cavities of each.
//
// A region is the interior of the union of cells of one label that facets join: edges and vertices alone join
// nothing. It is open: its Euler characteristic is the number of its cells, minus that of the facets, plus
// that of the edges, minus that of the vertices around which all cells are its own, because the open region
// and its compact supports have opposite numbers in three dimensions. What is around a region is closed: two
// boundary facets with a common vertex are at one component of it. A region is connected, so each component
// around it has a connected boundary: otherwise a closed path through both would cross one part of that
// boundary once, which no path in space does. The cavities are the components of boundary facets minus one.
#pragma once

#include <cstdint>
#include <vector>

#include "claims/region_graph.h"
#include "geometry/adjacency.h"
#include "mesh.h"

namespace podm::verify {

struct TopologyOfMesh {
  std::vector<LabelRegion> regions;
  std::vector<CellId> first;             ///< a cell of each region
  std::vector<std::uint32_t> region_of;  ///< by cell; kNone for cells of the background
};

/// Facets of three or more cells join nothing. Takes 24 bytes per cell, and 48 per
/// boundary facet.
TopologyOfMesh find_topology_of_mesh(const Mesh& mesh, const Adjacency& adjacency);

}  // namespace podm::verify
