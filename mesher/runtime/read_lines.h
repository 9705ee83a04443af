// Which lines of an array that nobody writes the caches of each node have: those that it has read. They are
// taken to keep all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/access_tally.h"

namespace podm {

/// For one thread alone, which plays the workers of all nodes.
class ReadLines {
 public:
  static constexpr std::size_t kBytesPerLine = 64;

  ReadLines(std::size_t num_bytes, int num_nodes)
      : of_node_(static_cast<std::size_t>(num_nodes), std::vector<bool>(num_bytes / kBytesPerLine + 1)) {}

  /// Whether the node has not read the line of that byte before; now it has.
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
