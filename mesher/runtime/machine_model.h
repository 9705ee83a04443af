// A machine by description, with what it costs to work on it: what virtual time needs to play a machine that
// nobody has at hand. Descriptions and their keys: experiments/machines.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/time_costs.h"
#include "runtime/topology.h"

namespace podm {

struct MachineModel {
  /// For the reader: no cost uses it. The time of work that caches answer is in `core_speed`.
  struct Cache {
    int level = 1;
    double kib = 0;
    int cores = 1;  ///< that share it
    double latency_s = 0;
  };

  /// A node's hub, by which it is on the network, or a router.
  struct Station {
    std::string name;
    double service_s = 0;  ///< an access keeps it busy for so long; 0: it takes any number at once
  };

  std::string name;
  std::vector<std::string> sources = {};  ///< where the figures are from
  Topology topology;  ///< latencies between nodes, and so the ranks of hops, are those below
  double clock_ghz = 0;
  double core_speed = 1;           ///< of one core, over the core that costs of work were measured on
  double speed_when_full = 1;      ///< of each core while all are at work, over one that works alone
  std::vector<Cache> caches = {};  ///< by level
  double local_latency_s = 0;      ///< of an access that no cache answers, to the node's own memory
  double hop_latency_s = 0;        ///< what each link on the way adds
  double miss_share = 0;  ///< of counted accesses to other nodes' memory: those that no cache answers
  std::vector<Station> stations = {};         ///< the hubs by node, then the routers
  std::vector<std::vector<int>> routes = {};  ///< in rows, by node and owner's node
  double retries = 0;  ///< an access that waits at a station lengthens service there by this share of itself
  double wake_s = 0;   ///< until a thread that sleeps runs again
  double lock_s = 0;   ///< taking and giving back a mutex that nobody holds
  TimeCosts costs = {};  ///< of work; studies of the model take one times a factor (cost_factor.h)

  int num_nodes() const { return topology.num_nodes(); }
  /// Of one of so many cores at work: what they share slows them down in step with their number.
  double speed_of_one_of(std::size_t num_working) const {
    const double most_others = std::max(1, topology.num_cores() - 1);
    const double others = std::min(static_cast<double>(num_working) - 1, most_others);
    return core_speed * (1 - (1 - speed_when_full) * others / most_others);
  }
  /// The stations that an access from a node to another one's memory passes, both hubs included; none to its
  /// own.
  const std::vector<int>& route(int from, int to) const { return routes.at(from * num_nodes() + to); }
  /// On the shortest way: 0 on the same node.
  int num_links(int from, int to) const {
    return from == to ? 0 : static_cast<int>(route(from, to).size()) - 1;
  }
  /// Of an access that no cache answers and that waits nowhere.
  double latency_s(int from, int to) const { return local_latency_s + num_links(from, to) * hop_latency_s; }

  /// Throws TopologyError "file:line:column: fault", or "file: fault" when the file is not there.
  static MachineModel from_file(const std::filesystem::path& path);
};

}  // namespace podm
