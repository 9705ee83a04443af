// The machine as the mesher sees it: which processors there are, which NUMA node's memory is near to each,
// and how far the nodes are from one another. The machine at hand or a described one, both by hwloc
// [Broquedis et al., PDP 2010].
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

struct hwloc_topology;

namespace podm {

/// A machine that cannot be read or makes no sense; the message names the file or description and the fault.
class TopologyError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A logical processor. Cores, nodes and sockets are numbered from 0 over the machine, in hwloc's order.
struct Processor {
  int os_index = 0;  // the operating system's number: what a thread is bound to
  int core = 0;
  int node = 0;    // the NUMA node whose memory is nearest
  int socket = 0;  // hwloc's package
  int thread = 0;  // 0 for the first hardware thread of the core, 1, 2, ... for its siblings
};

class Topology {
 public:
  /// The processors that this process may use: its cgroup's and its affinity's. Ask before binding threads.
  static Topology of_this_machine();
  /// The machine that an hwloc XML file describes, as `lstopo FILE.xml` or to_xml() writes it.
  /// Damage to the XML is refused; hwloc itself may not survive objects whose sets of processors are left
  /// out.
  static Topology from_file(const std::filesystem::path& path);
  /// A regular machine in hwloc's words, e.g. "pack:2 numa:2 core:8 pu:1". `latencies`, when given, has a row
  /// for each node and in it a latency to each node, in any unit.
  static Topology synthetic(const std::string& description, const std::vector<std::uint64_t>& latencies = {});

  /// They are in hwloc's order: neighbours in it are neighbours in the machine.
  const std::vector<Processor>& processors() const { return processors_; }
  int num_cores() const { return num_cores_; }
  int num_nodes() const { return static_cast<int>(node_os_indices_.size()); }
  int num_sockets() const { return num_sockets_; }
  /// The operating system's number of a node, as page queries give it.
  int node_os_index(int node) const { return node_os_indices_.at(node); }
  /// False for a described machine, to whose processors no thread can be bound.
  bool is_this_machine() const;

  /// 0 on the same node; otherwise the rank of the latency between the nodes, by hwloc's matrix, among all
  /// that occur between two nodes: 1 is the least. 1 where no matrix tells. Symmetric: of two directions the
  /// slower one counts.
  int hops(int node_a, int node_b) const { return hops_.at(node_a * num_nodes() + node_b); }
  int max_hops() const;

  std::string to_xml() const;

 private:
  using Handle = std::shared_ptr<hwloc_topology>;
  Topology(Handle machine, const std::string& name);  // the name is for messages
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
