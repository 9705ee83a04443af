// The lines of a read-only array that each node's caches contain: the lines that the node has read. The model
// assumes that caches keep all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/access_tally.h"

namespace podm {

/// For one thread only, which simulates the workers of all nodes.
class ReadLines {
 public:
  static constexpr std::size_t kBytesPerLine = 64;

  ReadLines(std::size_t num_bytes, int num_nodes)
      : of_node_(static_cast<std::size_t>(num_nodes), std::vector<bool>(num_bytes / kBytesPerLine + 1)) {}

  /// Returns true if the node has not read the line of that byte before, and marks it as read.
  bool is_first(NodeIndex node, std::size_t byte) {
    std::vector<bool>& is_read = of_node_[node];
    const std::size_t line = byte / kBytesPerLine;
    const bool is_first = !is_read[line];
    is_read[line] = true;
    return is_first;
  }

 private:
  std::vector<std::vector<bool>> of_node_;
};

}  // namespace podm
