// An hwloc topology that is destroyed with its owner.
#pragma once

#include <hwloc.h>

#include <memory>
#include <type_traits>

namespace podm::bench {

struct DestroyTopology {
  void operator()(hwloc_topology_t topology) const { hwloc_topology_destroy(topology); }
};
using Topology = std::unique_ptr<std::remove_pointer_t<hwloc_topology_t>, DestroyTopology>;

/// This machine's; null where hwloc finds none.
inline Topology load_topology() {
  hwloc_topology_t topology = nullptr;
  if (hwloc_topology_init(&topology) != 0) return {};
  Topology owner(topology);
  return hwloc_topology_load(topology) == 0 ? std::move(owner) : Topology();
}

}  // namespace podm::bench
