// An hwloc topology that is destroyed with its owner, and its caches.
#pragma once

#include <hwloc.h>

#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace podm::bench {

struct DestroyTopology {
  void operator()(hwloc_topology_t topology) const { hwloc_topology_destroy(topology); }
};
using Topology = std::unique_ptr<std::remove_pointer_t<hwloc_topology_t>, DestroyTopology>;

/// Returns this machine's topology; null where hwloc finds none.
inline Topology load_topology() {
  hwloc_topology_t topology = nullptr;
  if (hwloc_topology_init(&topology) != 0) return {};
  Topology owner(topology);
  return hwloc_topology_load(topology) == 0 ? std::move(owner) : Topology();
}

struct Cache {
  int level;
  std::size_t bytes;
};

/// Returns the data caches of a processor, nearest first.
inline std::vector<Cache> caches_of(hwloc_obj_t processor) {
  std::vector<Cache> caches;
  for (hwloc_obj_t object = processor; object != nullptr; object = object->parent)
    if (hwloc_obj_type_is_dcache(object->type) && object->attr->cache.size > 0)
      caches.push_back({static_cast<int>(object->attr->cache.depth), object->attr->cache.size});
  return caches;
}

}  // namespace podm::bench
