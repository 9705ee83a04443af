// The machine as the mesher sees it: its processors, the nearest NUMA node of each, and the distances between
// nodes. It is this machine or a described one, both by hwloc [Broquedis et al., PDP 2010].
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

struct hwloc_topology;

namespace podm {

/// A machine that cannot be read or is inconsistent; the message names the file or description and the fault.
class TopologyError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A logical processor. Cores, nodes and sockets are numbered from 0 over the machine, in hwloc's order.
struct Processor {
  int os_index = 0;  // the operating system's number, to which a thread is bound
  int core = 0;
  int node = 0;    // the NUMA node whose memory is nearest
  int socket = 0;  // hwloc's package
  int thread = 0;  // 0 for the first hardware thread of the core, 1, 2, ... for its siblings
};

class Topology {
 public:
  /// Returns this machine, with the processors that the process may use by its cgroup and its affinity. Call
  /// it before binding threads.
  static Topology of_this_machine();
  /// Reads the machine from an hwloc XML file, as `lstopo FILE.xml` or to_xml() writes it. Refuses damaged
  /// XML; hwloc itself may not survive objects that lack their sets of processors.
  static Topology from_file(const std::filesystem::path& path);
  /// Makes a regular machine from hwloc's synthetic description, e.g. "pack:2 numa:2 core:8 pu:1".
  /// `latencies`, if given, has one row per node with a latency to each node, in any unit.
  static Topology synthetic(const std::string& description, const std::vector<std::uint64_t>& latencies = {});

  /// The processors in hwloc's order: neighbours in it are neighbours in the machine.
  const std::vector<Processor>& processors() const { return processors_; }
  int num_cores() const { return num_cores_; }
  int num_nodes() const { return static_cast<int>(node_os_indices_.size()); }
  int num_sockets() const { return num_sockets_; }
  /// Returns the operating system's number of a node, as page queries return it.
  int node_os_index(int node) const { return node_os_indices_.at(node); }
  /// False for a described machine; threads cannot be bound to its processors.
  bool is_this_machine() const;

  /// Returns 0 on the same node. Otherwise returns the rank of the latency between the nodes, by hwloc's
  /// matrix, among all latencies that occur between two nodes: 1 is the least. Returns 1 if there is no
  /// matrix. Symmetric: the slower of the two directions counts.
  int hops(int node_a, int node_b) const { return hops_.at(node_a * num_nodes() + node_b); }
  int max_hops() const;

  std::string to_xml() const;

 private:
  using Handle = std::shared_ptr<hwloc_topology>;
  Topology(Handle machine, const std::string& name);  // the name is used in messages
  static Handle make_handle();
  void read_processors(const std::string& name);
  void read_hops();

  Handle machine_;
  std::vector<Processor> processors_;
  std::vector<int> node_os_indices_;  // by node
  std::vector<int> hops_;             // num_nodes rows
  int num_cores_ = 0;
  int num_sockets_ = 0;
};

}  // namespace podm
