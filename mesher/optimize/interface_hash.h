// A hash of the facets between labels, to which each cell adds its share without a look at its neighbours.
//
// A cell's share is the weight of its label times the sum of its facets' hashes, each with a sign that is the
// other one from the facet's other side. So a facet between two cells of one label adds nothing to the sum
// over all cells, and one between two labels its hash times the difference of their weights. Sums are modulo
// 2^64. Who gives a cell to another label changes the sum by the difference of its two shares, and who puts
// other cells of its label in a cavity's place not at all.
#pragma once

#include <cstdint>

#include "delaunay/mesh.h"

namespace podm {

/// What the cell adds to the hash if it has that label; nothing if that is the background.
std::uint64_t share_of_interface_hash(const Mesh& mesh, CellId c, LabelIndex label);

}  // namespace podm
