// Described machines that the runtime tests share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "runtime/topology.h"

namespace podm::test {

// Nodes are numbered by socket; every core has two hardware threads.
inline Topology two_sockets() { return Topology::synthetic("pack:2 numa:2 core:4 pu:2"); }

inline Topology one_node() { return Topology::synthetic("pack:1 core:8 pu:1"); }

// Returns the latencies from each of `num_nodes` nodes to each, in rows.
template <class Latency>
std::vector<std::uint64_t> latency_rows(int num_nodes, const Latency& latency) {
  std::vector<std::uint64_t> rows;
  for (int a = 0; a < num_nodes; ++a)
    for (int b = 0; b < num_nodes; ++b) rows.push_back(latency(a, b));
  return rows;
}

// Returns a ring of four nodes: neighbours are one hop apart, opposite nodes two.
inline Topology four_nodes() {
  return Topology::synthetic("numa:4 core:4 pu:1", latency_rows(4, [](int a, int b) {
                               const auto apart = static_cast<std::uint64_t>(a > b ? a - b : b - a);
                               return 10 + 5 * std::min(apart, 4 - apart);
                             }));
}

}  // namespace podm::test
