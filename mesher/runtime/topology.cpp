#include "runtime/topology.h"

#include <fmt/format.h>
#include <hwloc.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

namespace podm {

namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open())
    throw TopologyError(fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno)));
  std::ostringstream text;
  if (!(text << file.rdbuf())) throw TopologyError(path.string() + ": the file is empty");
  return text.str();
}

// Returns the first NUMA node beside the nearest ancestor that has one; null if none has.
hwloc_obj_t nearest_node(hwloc_obj_t object) {
  while (object != nullptr && object->memory_arity == 0) object = object->parent;
  if (object == nullptr) return nullptr;
  do object = object->memory_first_child;  // a memory-side cache has its node below it
  while (object != nullptr && object->type != HWLOC_OBJ_NUMANODE);
  return object;
}

int os_index_of(hwloc_obj_t object, const std::string& machine_name) {
  if (object->os_index == HWLOC_UNKNOWN_INDEX)
    throw TopologyError(fmt::format("{}: {} {} has no os_index", machine_name,
                                    hwloc_obj_type_string(object->type), object->logical_index));
  return static_cast<int>(object->os_index);
}

// Returns `otherwise` if hwloc knows no such ancestor.
int ancestor_index(hwloc_topology_t machine, hwloc_obj_type_t type, hwloc_obj_t object, unsigned otherwise) {
  const hwloc_obj_t ancestor = hwloc_get_ancestor_obj_by_type(machine, type, object);
  return static_cast<int>(ancestor != nullptr ? ancestor->logical_index : otherwise);
}

void add_latencies(hwloc_topology_t machine, const std::vector<std::uint64_t>& latencies) {
  const auto num_nodes = static_cast<std::size_t>(hwloc_get_nbobjs_by_type(machine, HWLOC_OBJ_NUMANODE));
  if (latencies.size() != num_nodes * num_nodes)
    throw TopologyError(fmt::format("{} latencies given, {} nodes need {}", latencies.size(), num_nodes,
                                    num_nodes * num_nodes));
  std::vector<hwloc_obj_t> nodes;
  for (std::size_t node = 0; node < num_nodes; ++node)
    nodes.push_back(hwloc_get_obj_by_type(machine, HWLOC_OBJ_NUMANODE, static_cast<unsigned>(node)));
  std::vector<hwloc_uint64_t> values(latencies.begin(), latencies.end());
  const auto matrix = hwloc_distances_add_create(
      machine, "NUMALatency", HWLOC_DISTANCES_KIND_FROM_USER | HWLOC_DISTANCES_KIND_MEANS_LATENCY, 0);
  if (matrix == nullptr ||
      hwloc_distances_add_values(machine, matrix, static_cast<unsigned>(num_nodes), nodes.data(),
                                 values.data(), 0) != 0 ||
      hwloc_distances_add_commit(machine, matrix, 0) != 0)
    throw TopologyError("hwloc does not accept these latencies");
}

}  // namespace

Topology::Handle Topology::make_handle() {
  hwloc_topology_t machine = nullptr;
  if (hwloc_topology_init(&machine) != 0) throw TopologyError("hwloc cannot be initialised");
  return {machine, hwloc_topology_destroy};
}

Topology Topology::of_this_machine() {
  Handle machine = make_handle();
  if (hwloc_topology_load(machine.get()) != 0) throw TopologyError("hwloc cannot read this machine");
  if (hwloc_topology_is_thissystem(machine.get()) == 0)
    throw TopologyError("HWLOC_XMLFILE or HWLOC_SYNTHETIC in the environment hides this machine: unset it");
  // hwloc omits the processors that the cgroup forbids, but ignores the affinity (taskset, a batch system).
  const std::shared_ptr<hwloc_bitmap_s> usable(hwloc_bitmap_alloc(), hwloc_bitmap_free);
  if (hwloc_get_cpubind(machine.get(), usable.get(), HWLOC_CPUBIND_PROCESS) == 0 &&
      hwloc_topology_restrict(machine.get(), usable.get(), 0) != 0)
    throw TopologyError("hwloc cannot restrict this machine to the processors that this process may use");
  return Topology(std::move(machine), "this machine");
}

Topology Topology::from_file(const std::filesystem::path& path) {
  const std::string xml = read_text(path);
  Handle machine = make_handle();
  // hwloc includes the final zero in the size.
  if (hwloc_topology_set_xmlbuffer(machine.get(), xml.c_str(), static_cast<int>(xml.size() + 1)) != 0 ||
      hwloc_topology_load(machine.get()) != 0)
    throw TopologyError(path.string() + ": not an hwloc XML description of a machine");
  return Topology(std::move(machine), path.string());
}

Topology Topology::synthetic(const std::string& description, const std::vector<std::uint64_t>& latencies) {
  Handle machine = make_handle();
  if (hwloc_topology_set_synthetic(machine.get(), description.c_str()) != 0 ||
      hwloc_topology_load(machine.get()) != 0)
    throw TopologyError(fmt::format("machine \"{}\": not a synthetic description for hwloc", description));
  if (!latencies.empty()) add_latencies(machine.get(), latencies);
  return Topology(std::move(machine), description);
}

Topology::Topology(Handle machine, const std::string& name) : machine_(std::move(machine)) {
  read_processors(name);
  read_hops();
}

void Topology::read_processors(const std::string& name) {
  hwloc_topology_t machine = machine_.get();
  std::map<int, int> num_threads;  // by core
  for (hwloc_obj_t object = nullptr; (object = hwloc_get_next_obj_by_type(machine, HWLOC_OBJ_PU, object));) {
    const hwloc_obj_t node = nearest_node(object);
    if (node == nullptr)
      throw TopologyError(fmt::format("{}: processor {} has no NUMA node", name, object->logical_index));
    Processor processor;
    processor.os_index = os_index_of(object, name);
    processor.core = ancestor_index(machine, HWLOC_OBJ_CORE, object, object->logical_index);
    processor.node = static_cast<int>(node->logical_index);
    processor.socket = ancestor_index(machine, HWLOC_OBJ_PACKAGE, object, 0);
    processor.thread = num_threads[processor.core]++;
    processors_.push_back(processor);
  }
  num_cores_ = static_cast<int>(num_threads.size());
  num_sockets_ = std::max(1, hwloc_get_nbobjs_by_type(machine, HWLOC_OBJ_PACKAGE));
  for (hwloc_obj_t node = nullptr; (node = hwloc_get_next_obj_by_type(machine, HWLOC_OBJ_NUMANODE, node));)
    node_os_indices_.push_back(os_index_of(node, name));
}

void Topology::read_hops() {
  const int n = num_nodes();
  hops_.assign(n * n, 1);
  for (int node = 0; node < n; ++node) hops_[node * n + node] = 0;

  unsigned num_matrices = 1;
  hwloc_distances_s* matrix = nullptr;
  if (hwloc_distances_get_by_type(machine_.get(), HWLOC_OBJ_NUMANODE, &num_matrices, &matrix,
                                  HWLOC_DISTANCES_KIND_MEANS_LATENCY, 0) != 0 ||
      num_matrices == 0)
    return;
  std::map<hwloc_uint64_t, std::vector<std::pair<unsigned, unsigned>>>
      pairs;  // by latency, in the slower direction
  for (unsigned i = 0; i < matrix->nbobjs; ++i)
    for (unsigned j = 0; j < i; ++j)
      pairs[std::max(matrix->values[i * matrix->nbobjs + j], matrix->values[j * matrix->nbobjs + i])]
          .emplace_back(matrix->objs[i]->logical_index, matrix->objs[j]->logical_index);
  hwloc_distances_release(machine_.get(), matrix);
  int rank = 0;
  for (const auto& [latency, at_this_latency] : pairs) {
    ++rank;
    for (const auto& [a, b] : at_this_latency) hops_[a * n + b] = hops_[b * n + a] = rank;
  }
}

bool Topology::is_this_machine() const { return hwloc_topology_is_thissystem(machine_.get()) != 0; }

int Topology::max_hops() const { return *std::max_element(hops_.begin(), hops_.end()); }

std::string Topology::to_xml() const {
  char* xml = nullptr;
  int size = 0;
  if (hwloc_topology_export_xmlbuffer(machine_.get(), &xml, &size, 0) != 0)
    throw TopologyError("hwloc cannot write this machine as XML");
  std::string text(xml);
  hwloc_free_xmlbuffer(machine_.get(), xml);
  return text;
}

}  // namespace podm
