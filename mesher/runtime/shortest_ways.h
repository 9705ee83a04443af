// The shortest ways between the nodes of a network, one for each pair, chosen so that equal ways share the
// load.
#pragma once

#include <vector>

namespace podm {

/// The vertices that one link leads to, by vertex. A link leads both ways.
using Neighbours = std::vector<std::vector<int>>;

/// The links on the shortest way from `start` to each vertex; -1: no way leads there.
std::vector<int> links_from(const Neighbours& neighbours, int start);

/// A shortest way from each of the first `num_ends` vertices to each of them, in rows: all its vertices, both
/// ends included; none from an end to itself. Of equal ways that one is taken on whose vertices fewer ways
/// have met, pair after pair, so that the same network always gives the same ways. The network is connected.
std::vector<std::vector<int>> shortest_ways(const Neighbours& neighbours, int num_ends);

}  // namespace podm
