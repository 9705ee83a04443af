// Latencies of the memory hierarchy: Table 3 for this machine.
#pragma once

#include <nlohmann/json.hpp>

namespace podm::bench {

/// Pins this thread and measures a load from working sets of all sizes, from the caches of its core to the
/// memory of each NUMA node. `memory_levels`: a line a cache and a node, as in the paper's Table 3;
/// `latency`: all working sets. What cannot be measured is "unavailable: why". Takes some 5 s; files go to
/// `scratch_folder`. Throws std::runtime_error where hwloc finds no topology.
nlohmann::ordered_json measure_memory_levels();

}  // namespace podm::bench
