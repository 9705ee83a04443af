#include "process/usable_processors.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>

namespace podm::bench {

std::vector<int> usable_processor_ids() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  std::vector<int> ids;
  if (sched_getaffinity(0, sizeof(allowed), &allowed) != 0) return ids;  // more than 1024 processors
  for (int id = 0; id < CPU_SETSIZE; ++id)
    if (CPU_ISSET(id, &allowed)) ids.push_back(id);
  return ids;
}

int usable_processors() {
  const std::size_t allowed = usable_processor_ids().size();
  return std::max(1,
                  allowed > 0 ? static_cast<int>(allowed) : static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)));
}

}  // namespace podm::bench
