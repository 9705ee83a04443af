#include "runtime/numa_memory.h"

#include <numa.h>
#include <numaif.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace podm {

PageNodes nodes_of_pages(std::span<const void* const> addresses) {
  if (numa_available() < 0) return {{}, "this system has no NUMA support"};
  const auto page_size = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  std::vector<void*> pages;
  for (const void* address : addresses)
    pages.push_back(reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(address) & ~(page_size - 1)));
  std::vector<int> status(pages.size(), PageNodes::kNowhere);
  // Without target nodes, move_pages() moves nothing and returns the node of each page: a negative error
  // number for a page that is nowhere.
  if (move_pages(0, pages.size(), pages.data(), nullptr, status.data(), 0) != 0)
    return {{}, std::string("the system refuses the query: ") + std::strerror(errno)};
  for (int& node : status) node = std::max(node, PageNodes::kNowhere);
  return {std::move(status), ""};
}

}  // namespace podm
