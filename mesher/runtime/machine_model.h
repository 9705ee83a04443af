// The description of a machine, with the costs of work on it. Virtual time uses it to simulate a machine that
// is not available. Descriptions and their keys: experiments/machines.
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
  /// For the reader only: no cost uses it. `core_speed` includes the time of accesses that caches answer.
  struct Cache {
    int level = 1;
    double kib = 0;
    int cores = 1;  ///< that share it
    double latency_s = 0;
  };

  /// A node's hub, which connects it to the network, or a router.
  struct Station {
    std::string name;
    double service_s = 0;  ///< the time that an access keeps it busy; 0: it serves any number at once
  };

  std::string name;
  std::vector<std::string> sources = {};  ///< sources of the figures
  Topology topology;  ///< latencies between nodes, and therefore the ranks of hops, are those below
  double clock_ghz = 0;
  double core_speed = 1;       ///< of one core, relative to the core on which the costs of work were measured
  double speed_when_full = 1;  ///< of each core while all work, relative to one core that works alone
  std::vector<Cache> caches = {};  ///< by level
  double local_latency_s = 0;      ///< of an access to the node's own memory that no cache answers
  double hop_latency_s = 0;        ///< added by each link on the way
  double miss_share = 0;  ///< share of the counted accesses to other nodes' memory that no cache answers
  std::vector<Station> stations = {};         ///< the hubs by node, then the routers
  std::vector<std::vector<int>> routes = {};  ///< indexed by node and owner's node, in rows
  double retries = 0;  ///< each access that waits at a station lengthens the service there by this share
  double wake_s = 0;   ///< until a sleeping thread runs again
  double lock_s = 0;   ///< to take and release a mutex that no thread holds
  /// For a cache line that many threads write to pass from one of them to another.
  double line_transfer_s = 0;
  /// For the system to provide a page of 4 KiB at its first touch.
  double page_fault_s = 0;
  TimeCosts costs = {};  ///< of work; studies of the model multiply one by a factor (cost_factor.h)

  int num_nodes() const { return topology.num_nodes(); }
  /// Returns the speed of one core while `num_working` cores work: it falls linearly with the number of
  /// others, because they share resources.
  double speed_of_one_of(std::size_t num_working) const {
    const double most_others = std::max(1, topology.num_cores() - 1);
    const double others = std::min(static_cast<double>(num_working) - 1, most_others);
    return core_speed * (1 - (1 - speed_when_full) * others / most_others);
  }
  /// Returns the stations on the way of an access from a node to another node's memory, both hubs included.
  /// Empty for the node's own memory.
  const std::vector<int>& route(int from, int to) const { return routes.at(from * num_nodes() + to); }
  /// Returns the number of links on the shortest way; 0 on the same node.
  int num_links(int from, int to) const {
    return from == to ? 0 : static_cast<int>(route(from, to).size()) - 1;
  }
  /// Returns the latency of an access that no cache answers and that waits nowhere.
  double latency_s(int from, int to) const { return local_latency_s + num_links(from, to) * hop_latency_s; }

  /// Throws TopologyError "file:line:column: fault", or "file: fault" if the file does not exist.
  static MachineModel from_file(const std::filesystem::path& path);
};

}  // namespace podm
