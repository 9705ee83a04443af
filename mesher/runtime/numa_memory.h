// Where memory lies. Placement itself is the kernel's first touch: a page comes to the node of the thread
// that first writes to it, so a worker's arrays (HugeArray) lie near it when it fills them itself.
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
  std::string unavailable;  // why none were told; otherwise empty
};

/// The nodes that hold the pages of some addresses.
using PageQuery = std::function<PageNodes(std::span<const void* const>)>;
/// The system's answer. Looks only: a page that was never touched stays so.
PageNodes nodes_of_pages(std::span<const void* const> addresses);

}  // namespace podm
