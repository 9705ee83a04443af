// The shortest paths between the nodes of a network, one for each pair. Paths of equal length are chosen to
// share the load.
#pragma once

#include <vector>

namespace podm {

/// For each vertex, the vertices that one link leads to. A link leads both ways.
using Neighbours = std::vector<std::vector<int>>;

/// Returns the number of links on the shortest path from `start` to each vertex; -1 if there is no path.
std::vector<int> links_from(const Neighbours& neighbours, int start);

/// Returns a shortest path from each of the first `num_ends` vertices to each of them, in rows: all its
/// vertices, both ends included; empty from an end to itself. Among equal paths it chooses vertices that
/// fewer earlier paths have met, pair after pair; the same network therefore always gives the same paths. The
/// network must be connected.
std::vector<std::vector<int>> shortest_paths(const Neighbours& neighbours, int num_ends);

}  // namespace podm
