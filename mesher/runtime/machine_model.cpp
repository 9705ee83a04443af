#include "runtime/machine_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "runtime/shortest_paths.h"
#include "runtime/toml_section.h"

namespace podm {

namespace {

// Known machines are far smaller. A larger figure is treated as an error.
constexpr std::int64_t kMostNodes = 256, kMostRouters = 1024, kMostSockets = 64, kMostCores = 1024;
constexpr std::int64_t kMostProcessors = 16'384;  // of all nodes
constexpr double kMostCycles = 1e9, kMostAccesses = 1e15, kMostMicroseconds = 1e6, kMostGib = 1e6;
constexpr double kLeast = 1e-9;  // for values that must be positive

std::vector<std::string> read_sources(TomlSection& file) {
  std::vector<std::string> sources;
  for (const TomlValue& source : file.values("sources")) sources.push_back(source.text());
  return sources;
}

struct Processors {
  std::int64_t sockets = 1, cores_per_socket = 1;  // of a node
  double clock_hz = 0, core_speed = 1, speed_when_full = 1;
  std::vector<MachineModel::Cache> caches;
};

void read_cache(TomlSection& section, Processors& processors) {
  const std::int64_t most_cores = processors.sockets * processors.cores_per_socket;
  std::vector<MachineModel::Cache>& caches = processors.caches;
  caches.push_back({.level = static_cast<int>(section.count("level", 1, 9)),
                    .kib = section.number("kib", kLeast, kMostGib * (1 << 20)),
                    .cores = static_cast<int>(section.count("cores", 1, most_cores)),
                    .latency_s = section.number("cycles", kLeast, kMostCycles) / processors.clock_hz});
  section.done();
  if (caches.size() == 1) return;
  const MachineModel::Cache &inner = *(caches.end() - 2), &outer = caches.back();
  if (outer.level <= inner.level || outer.latency_s <= inner.latency_s)
    section.fail("caches must be listed from the fastest to the slowest, by level");
}

Processors read_processors(TomlSection section) {
  Processors processors;
  processors.sockets = section.count("sockets_per_node", 1, kMostSockets);
  processors.cores_per_socket = section.count("cores_per_socket", 1, kMostCores);
  processors.clock_hz = 1e9 * section.number("clock_ghz", 1e-3, 1e3);
  processors.core_speed = section.number("core_speed", 1e-3, 1e3);
  processors.speed_when_full = section.number("speed_when_full", 1, kLeast, 1);
  for (TomlSection& cache : section.table_array("caches")) read_cache(cache, processors);
  section.done();
  return processors;
}

struct Network {
  int num_nodes = 1, num_routers = 0;
  double hub_service_s = 0, router_service_s = 0, retries = 0;
  Neighbours neighbours;  // of the nodes, then of the routers
};

// Returns the vertex of "node 3" or "router 1".
int link_end(const TomlValue& value, const Network& network) {
  const std::string text = value.text();
  const bool is_router = text.starts_with("router ");
  const std::string_view digits =
      std::string_view(text).substr(std::min(text.find(' '), text.size() - 1) + 1);
  int number = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const int most = is_router ? network.num_routers : network.num_nodes;
  if ((!is_router && !text.starts_with("node ")) || error != std::errc() ||
      end != digits.data() + digits.size() || number < 0 || number >= most)
    value.fail(
        fmt::format("\"{}\" is none of the {} nodes and {} routers, which are \"node "
                    "0\", ... and \"router 0\", ...",
                    text, network.num_nodes, network.num_routers));
  return is_router ? network.num_nodes + number : number;
}

void read_link(const TomlValue& link, Network& network) {
  const auto* const ends = link.as<TomlValue::Array>();
  if (ends == nullptr || ends->members.size() != 2)
    link.fail("a link is a pair such as [\"node 0\", \"router 0\"]");
  const int a = link_end(ends->members[0], network), b = link_end(ends->members[1], network);
  if (a == b) link.fail("a link leads from an end to itself");
  std::vector<int>& others = network.neighbours[a];
  if (std::find(others.begin(), others.end(), b) != others.end())
    link.fail("a second link between these ends");
  others.push_back(b);
  network.neighbours[b].push_back(a);
}

std::string name_of(const Network& network, int vertex) {
  return vertex < network.num_nodes ? fmt::format("node {}", vertex)
                                    : fmt::format("router {}", vertex - network.num_nodes);
}

void refuse_unconnected(const TomlSection& section, const Network& network) {
  const std::vector<int> links = links_from(network.neighbours, 0);
  const auto apart = std::find(links.begin(), links.end(), -1);
  if (apart != links.end())
    section.fail(fmt::format("{} is not connected to node 0",
                             name_of(network, static_cast<int>(apart - links.begin()))));
}

double read_service_s(TomlSection& section, std::string_view key) {
  return 1 / section.number(key, std::numeric_limits<double>::infinity(), kLeast, kMostAccesses);
}

Network read_network(TomlSection section) {
  Network network;
  network.num_nodes = static_cast<int>(section.count("nodes", 1, 1, kMostNodes));
  network.num_routers = static_cast<int>(section.count("routers", 0, 0, kMostRouters));
  network.neighbours.assign(network.num_nodes + network.num_routers, {});
  for (const TomlValue& link : section.values("links")) read_link(link, network);
  refuse_unconnected(section, network);
  network.hub_service_s = read_service_s(section, "hub_accesses_per_s");
  network.router_service_s = read_service_s(section, "router_accesses_per_s");
  network.retries = section.number("retries", 0, 0, 1e3);
  section.done();
  return network;
}

std::vector<MachineModel::Station> stations_of(const Network& network) {
  std::vector<MachineModel::Station> stations;
  for (int vertex = 0; vertex < network.num_nodes + network.num_routers; ++vertex)
    stations.push_back({name_of(network, vertex),
                        vertex < network.num_nodes ? network.hub_service_s : network.router_service_s});
  return stations;
}

struct Memory {
  double gib_per_node = 0, local_latency_s = 0, hop_latency_s = 0, miss_share = 0;
};

Memory read_memory(TomlSection section, const Processors& processors, int num_nodes) {
  const bool is_alone = num_nodes == 1;
  Memory memory;
  memory.gib_per_node = section.number("gib_per_node", kLeast, kMostGib);
  memory.local_latency_s = section.number("local_cycles", kLeast, kMostCycles) / processors.clock_hz;
  if (!processors.caches.empty() && memory.local_latency_s <= processors.caches.back().latency_s)
    section.fail("local_cycles", "memory is slower than any cache");
  if (!is_alone || section.has("cycles_per_hop"))
    memory.hop_latency_s = section.number("cycles_per_hop", kLeast, kMostCycles) / processors.clock_hz;
  if (!is_alone || section.has("miss_share")) memory.miss_share = section.number("miss_share", 0, 1);
  section.done();
  return memory;
}

Topology topology_of(const Processors& processors, const Memory& memory, int num_nodes,
                     const std::vector<std::vector<int>>& routes) {
  const std::string description = fmt::format("group:{} [numa(memory={})] pack:{} core:{} pu:1", num_nodes,
                                              std::llround(memory.gib_per_node * (1 << 30)),
                                              processors.sockets, processors.cores_per_socket);
  if (num_nodes == 1) return Topology::synthetic(description);
  std::vector<std::uint64_t> latencies;  // in whole picoseconds
  for (const std::vector<int>& route : routes) {
    const auto num_links = static_cast<double>(std::max<std::size_t>(route.size(), 1) - 1);
    latencies.push_back(std::llround(1e12 * (memory.local_latency_s + num_links * memory.hop_latency_s)));
  }
  return Topology::synthetic(description, latencies);
}

}  // namespace

MachineModel MachineModel::from_file(const std::filesystem::path& path) try {
  const TomlValue table = parse_ascii_toml(path.string());
  TomlSection file(table, "a machine");
  const std::string name = file.text("name");
  const std::vector<std::string> sources = read_sources(file);
  const Processors processors = read_processors(file.table("processor"));
  const Network network = read_network(file.optional_table("network"));
  const Memory memory = read_memory(file.table("memory"), processors, network.num_nodes);
  TomlSection system = file.table("system");
  const double wake_us = system.number("wake_us", 0, kMostMicroseconds);
  const double lock_us = system.number("lock_us", 0, kMostMicroseconds);
  const double line_transfer_ns = system.number("line_transfer_ns", 0, 0, kMostMicroseconds);
  const double page_fault_us = system.number("page_fault_us", 0, 0, kMostMicroseconds);
  system.done();
  file.done();
  if (network.num_nodes * processors.sockets * processors.cores_per_socket > kMostProcessors)
    file.fail(fmt::format("a machine of more than {} cores", kMostProcessors));
  const std::vector<std::vector<int>> routes = shortest_paths(network.neighbours, network.num_nodes);
  return {.name = name,
          .sources = sources,
          .topology = topology_of(processors, memory, network.num_nodes, routes),
          .clock_ghz = processors.clock_hz / 1e9,
          .core_speed = processors.core_speed,
          .speed_when_full = processors.speed_when_full,
          .caches = processors.caches,
          .local_latency_s = memory.local_latency_s,
          .hop_latency_s = memory.hop_latency_s,
          .miss_share = memory.miss_share,
          .stations = stations_of(network),
          .routes = routes,
          .retries = network.retries,
          .wake_s = wake_us * 1e-6,
          .lock_s = lock_us * 1e-6,
          .line_transfer_s = line_transfer_ns * 1e-9,
          .page_fault_s = page_fault_us * 1e-6};
} catch (const TomlError& error) {
  throw TopologyError(error.what());
}

}  // namespace podm
