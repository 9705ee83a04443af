#include "runtime/numa_memory.h"

#include <numa.h>
#include <numaif.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace podm {

PageNode node_of_page(const void* address) {
  if (numa_available() < 0) return {{}, "this system has no NUMA support"};
  const auto page_size = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  void* page = reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(address) & ~(page_size - 1));
  int status = 0;
  // Without target nodes move_pages moves nothing and tells where each page is.
  if (move_pages(0, 1, &page, nullptr, &status, 0) != 0)
    return {{}, std::string("the system refuses the query: ") + std::strerror(errno)};
  if (status == -ENOENT) return {{}, "the page was never touched"};
  if (status == -EFAULT) return {{}, "no page of this process, or one only read so far"};
  if (status < 0) return {{}, std::strerror(-status)};
  return {status, ""};
}

}  // namespace podm
