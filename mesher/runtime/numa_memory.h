// Where memory lies. Placement itself is the kernel's first touch: a page comes to the node of the thread
// that first writes to it, so a worker's arrays (HugeArray) lie near it when it fills them itself.
#pragma once

#include <optional>
#include <string>

namespace podm {

struct PageNode {
  std::optional<int> os_index;  // the operating system's number of the node (Topology::node_os_index)
  std::string unavailable;      // why there is none, e.g. the page was never touched; otherwise empty
};

/// The node that holds the page of an address. Looks only: a page that was never touched stays so.
PageNode node_of_page(const void* address);

}  // namespace podm
