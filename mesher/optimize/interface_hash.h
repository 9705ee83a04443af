// A hash of the facets between labels, to which each cell adds its share without reading its neighbors.
//
// A cell's share is the weight of its label times the sum of its facets' hashes. The sign of a facet's hash
// is opposite on the two sides of the facet. A facet between two cells of one label therefore adds nothing to
// the sum over all cells, and a facet between two labels adds its hash times the difference of their weights.
// Sums are modulo 2^64. A worker that gives a cell to another label changes the sum by the difference of the
// cell's two shares. A worker that replaces a cavity by other cells of its label does not change the sum.
#pragma once

#include <cstdint>

#include "delaunay/mesh.h"

namespace podm {

/// Returns the cell's share of the hash if it has that label; 0 for the background.
std::uint64_t share_of_interface_hash(const Mesh& mesh, CellId c, LabelIndex label);

}  // namespace podm
