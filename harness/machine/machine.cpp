#include "machine/machine.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "machine/hwloc_topology.h"
#include "machine/identity.h"
#include "process/usable_processors.h"

namespace podm::bench {
namespace {

// Removes the host name, which is private. hwloc writes one element per line.
std::string without_host_name(const std::string& xml) {
  std::istringstream lines(xml);
  std::string text;
  for (std::string line; std::getline(lines, line);)
    if (line.find("name=\"HostName\"") == std::string::npos) text += line + "\n";
  return text;
}

std::string xml_of(hwloc_topology_t topology) {
  char* buffer = nullptr;
  int size = 0;
  if (hwloc_topology_export_xmlbuffer(topology, &buffer, &size, 0) != 0) return {};
  const std::string xml(buffer, static_cast<std::size_t>(std::max(0, size - 1)));  // it ends with a null
  hwloc_free_xmlbuffer(topology, buffer);
  return without_host_name(xml);
}

}  // namespace

Machine this_machine() {
  Machine machine;
  machine.summary.cpu = value_of("/proc/cpuinfo", "model name");
  const Topology topology = load_topology();
  const auto count = [&](hwloc_obj_type_t type) -> Count {
    if (!topology) return Unavailable{"hwloc finds no topology"};
    return static_cast<std::uint64_t>(std::max(0, hwloc_get_nbobjs_by_type(topology.get(), type)));
  };
  machine.summary.packages = count(HWLOC_OBJ_PACKAGE);
  machine.summary.numa_nodes = count(HWLOC_OBJ_NUMANODE);
  machine.summary.cores = count(HWLOC_OBJ_CORE);
  machine.summary.processors = count(HWLOC_OBJ_PU);
  machine.summary.usable_processors = usable_processors();
  machine.summary.identity = identity_of(topology.get());
  if (topology) machine.topology_xml = xml_of(topology.get());
  return machine;
}

std::string kernel_name() {
  utsname name{};
  uname(&name);
  return fmt::format("{} {} {}", name.sysname, name.release, name.machine);
}

// The line has the form "key: 123 kB".
Count meminfo_bytes(const std::string& key) {
  const std::string kibibytes = value_of("/proc/meminfo", key);
  if (kibibytes.starts_with(Unavailable::kPrefix))
    return Unavailable{fmt::format("/proc/meminfo has no '{}'", key)};
  return std::uint64_t{1024} * std::stoull(kibibytes);
}

std::string value_in(std::istream& lines, const std::string& key) {
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(key))
      if (const auto begin = line.find_first_not_of(" \t", line.find(':') + 1); begin != std::string::npos)
        return line.substr(begin);
  return "";
}

std::string value_of(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  const std::string value = value_in(file, key);
  return value.empty() ? fmt::format("unavailable: {} has no '{}'", path, key) : value;
}

}  // namespace podm::bench
