// Latencies of the memory hierarchy: Table 3 for this machine.
#pragma once

#include "rows/mesher_record.h"

namespace podm::bench {

/// Pins this thread and measures loads from working sets of all sizes, from the caches of its core to the
/// memory of each NUMA node. Takes about 5 s. Throws std::runtime_error if hwloc finds no topology.
MemoryLevelsRecord measure_memory_levels();

}  // namespace podm::bench
