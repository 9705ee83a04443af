#include "machine/memory_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "machine/hwloc_topology.h"
#include "machine/machine.h"
#include "machine/pointer_chase.h"
#include "process/ask.h"
#include "rows/order_statistics.h"

namespace podm::bench {
namespace {

constexpr std::size_t kSmallestSet = std::size_t{4} << 10, kLeastMemorySet = std::size_t{256} << 20;
constexpr std::size_t kMemoryOverCache = 4;  // at most a quarter of such a set hits the cache
constexpr int kRepeats = 7;
constexpr std::size_t kLoads = 250'000;  // a repeat takes about 30 ms from memory
constexpr std::uint64_t kSeed = 1;
constexpr double kBenchTimeoutS = 60;

// Measures loads from one working set in the memory of a node. Throws std::runtime_error if the set cannot be
// bound to the node.
LatencyRecord latency(hwloc_topology_t topology, std::size_t bytes, hwloc_obj_t node) {
  const auto bind = [&](void* memory, std::size_t size) {
    constexpr int kFlags = HWLOC_MEMBIND_BYNODESET | HWLOC_MEMBIND_STRICT;
    if (hwloc_get_nbobjs_by_type(topology, HWLOC_OBJ_NUMANODE) > 1 &&
        hwloc_set_area_membind(topology, memory, size, node->nodeset, HWLOC_MEMBIND_BIND, kFlags) != 0)
      throw std::runtime_error(fmt::format("memory cannot be bound to node {}", node->os_index));
  };
  PointerChase chase(bytes, kSeed, bind);
  // The shuffle visited all lines at random. The walk brings those of a small set into the nearest caches.
  chase.walk(std::min(chase.num_lines(), kLoads));
  std::vector<double> seconds, cycles;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const double clock = cycles_per_second();
    seconds.push_back(chase.seconds_per_load(kLoads));
    cycles.push_back(seconds.back() * clock);
  }
  return {bytes, static_cast<int>(node->os_index), 1e9 * median(seconds), median(cycles),
          chase.huge_page_share()};
}

// Returns the clock cycles per cache line when likwid-bench streams through the working set with the
// prefetchers.
Measured likwid_bench(std::size_t bytes) {
  if (!is_installed("likwid-bench")) return Unavailable{"likwid-bench is not installed"};
  const Reply reply =
      ask({"likwid-bench", "-t", "clload", "-w", fmt::format("N:{}B:1", bytes)}, kBenchTimeoutS);
  std::istringstream lines(reply.text);
  const std::string cycles = value_in(lines, "Cycles per cacheline");
  if (!reply.succeeded() || cycles.empty()) return Unavailable{"likwid-bench: " + reply.failure_text()};
  return std::stod(cycles);
}

// Returns the level with its measurement, or with the reason why there is none.
MemoryLevel level_of(hwloc_topology_t topology, MemoryLevel level, std::size_t bytes, hwloc_obj_t node) {
  try {
    const LatencyRecord measured = latency(topology, bytes, node);
    level.working_set_bytes = measured.working_set_bytes;
    level.node = measured.node;
    level.ns = measured.ns;
    level.cycles = measured.cycles;
    level.huge_page_share = measured.huge_page_share;
  } catch (const std::exception& error) {
    level.ns = level.cycles = Unavailable{error.what()};
  }
  return level;
}

// A level that is not measured yet.
MemoryLevel level_named(int level, const std::string& module, std::size_t bytes) {
  MemoryLevel named;
  named.level = level;
  named.module = module;
  named.size_bytes = bytes;
  return named;
}

std::vector<MemoryLevel> levels(hwloc_topology_t topology, const std::vector<Cache>& caches,
                                hwloc_obj_t own_node, std::size_t memory_set) {
  std::vector<MemoryLevel> measured;
  std::size_t last_bytes = kSmallestSet;
  for (const Cache& cache : caches) {
    // The size of the set is the geometric mean of the size of the cache before this one and its own size.
    // Other programs may occupy a part of the cache.
    const auto bytes = static_cast<std::size_t>(
        std::sqrt(static_cast<double>(last_bytes) * static_cast<double>(cache.bytes)));
    last_bytes = cache.bytes;
    const MemoryLevel level = level_named(cache.level, fmt::format("L{} cache", cache.level), cache.bytes);
    measured.push_back(level_of(topology, level, bytes, own_node));
    measured.back().likwid_bench_cycles_per_line = likwid_bench(bytes);
  }
  const int memory_level = caches.empty() ? 1 : caches.back().level + 1;
  for (hwloc_obj_t node = nullptr; (node = hwloc_get_next_obj_by_type(topology, HWLOC_OBJ_NUMANODE, node));) {
    const bool is_own = node == own_node;
    const std::string module =
        fmt::format("memory of {} node {}", is_own ? "the own" : "another", node->os_index);
    const MemoryLevel level = level_named(memory_level + !is_own, module, node->attr->numanode.local_memory);
    measured.push_back(level_of(topology, level, memory_set, node));
    if (is_own) measured.back().likwid_bench_cycles_per_line = likwid_bench(memory_set);
  }
  return measured;
}

// Returns no limit if the kernel does not report how much memory is available.
std::size_t available_bytes() {
  const std::string kibibytes = value_of("/proc/meminfo", "MemAvailable");
  return kibibytes.starts_with("unavailable") ? std::numeric_limits<std::size_t>::max()
                                              : 1024 * std::stoull(kibibytes);
}

hwloc_obj_t node_of(hwloc_topology_t topology, hwloc_obj_t processor) {
  for (hwloc_obj_t node = nullptr; (node = hwloc_get_next_obj_by_type(topology, HWLOC_OBJ_NUMANODE, node));)
    if (hwloc_bitmap_isset(node->cpuset, processor->os_index)) return node;
  throw std::runtime_error("the processor belongs to no NUMA node");
}

}  // namespace

MemoryLevelsRecord measure_memory_levels() {
  const Topology owner = load_topology();
  hwloc_topology_t topology = owner.get();
  // The last processor is used, because the first one serves most interrupts.
  hwloc_obj_t processor =
      topology == nullptr ? nullptr
                          : hwloc_get_obj_by_type(
                                topology, HWLOC_OBJ_PU,
                                static_cast<unsigned>(hwloc_get_nbobjs_by_type(topology, HWLOC_OBJ_PU) - 1));
  if (processor == nullptr) throw std::runtime_error("hwloc finds no topology");
  const bool is_pinned = hwloc_set_cpubind(topology, processor->cpuset, HWLOC_CPUBIND_THREAD) == 0;
  hwloc_obj_t own_node = node_of(topology, processor);
  const std::vector<Cache> caches = caches_of(processor);
  const std::size_t last_bytes = caches.empty() ? 0 : caches.back().bytes;
  const std::size_t memory_set =
      std::min(std::max(kLeastMemorySet, kMemoryOverCache * last_bytes), available_bytes() / 2);
  std::vector<LatencyRecord> sets;
  for (std::size_t bytes = kSmallestSet; bytes < memory_set; bytes *= 2)
    sets.push_back(latency(topology, bytes, own_node));
  return {static_cast<int>(processor->os_index), is_pinned, levels(topology, caches, own_node, memory_set),
          sets};
}

}  // namespace podm::bench
