// Queries of the node where memory lies. The kernel places memory by first touch: a page lies on the node of
// the thread that first writes to it. A worker's arrays (HugeArray) therefore lie near the worker if it fills
// them itself.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace podm {

struct PageNodes {
  static constexpr int kNowhere = -1;  // never touched, or no page of this process

  std::vector<int>
      os_indices;           // by address: the operating system's number of the node (Topology::node_os_index)
  std::string unavailable;  // why there are none; otherwise empty
};

/// Returns the nodes that hold the pages of the given addresses.
using PageQuery = std::function<PageNodes(std::span<const void* const>)>;
/// Queries the system. Only reads: a page that was never touched stays untouched.
PageNodes nodes_of_pages(std::span<const void* const> addresses);

}  // namespace podm
