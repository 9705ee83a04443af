#include "machine/identity.h"

#include <fmt/format.h>
#include <fstream>
#include <map>

#include "machine/hwloc_topology.h"
#include "machine/machine.h"

namespace podm::bench {
namespace {

constexpr std::uint64_t kGib = std::uint64_t{1} << 30;

std::map<std::string, std::string> values_of(std::istream& lines) {
  std::map<std::string, std::string> values;  // values of the first processor
  for (std::string line; std::getline(lines, line);) {
    const auto colon = line.find(':');
    const auto begin = line.find_first_not_of(" \t", colon == std::string::npos ? colon : colon + 1);
    if (begin != std::string::npos)
      values.emplace(line.substr(0, line.find_last_not_of(" \t", colon - 1) + 1), line.substr(begin));
  }
  return values;
}

Count number_in(const std::map<std::string, std::string>& values, const std::string& key) {
  const auto found = values.find(key);
  if (found == values.end()) return Unavailable{fmt::format("/proc/cpuinfo has no '{}'", key)};
  try {
    return static_cast<std::uint64_t>(std::stoull(found->second, nullptr, 0));  // Arm also writes 0x41
  } catch (const std::exception&) {
    return Unavailable{fmt::format("/proc/cpuinfo: '{}' is '{}', not a number", key, found->second)};
  }
}

std::variant<ByName<std::uint64_t>, Unavailable> cache_bytes(hwloc_topology_t topology) {
  hwloc_obj_t processor = topology == nullptr ? nullptr : hwloc_get_obj_by_type(topology, HWLOC_OBJ_PU, 0);
  if (processor == nullptr) return Unavailable{"hwloc finds no topology"};
  ByName<std::uint64_t> bytes;
  for (const Cache& cache : caches_of(processor)) bytes[fmt::format("L{}", cache.level)] = cache.bytes;
  if (bytes.empty()) return Unavailable{"hwloc finds no caches"};
  return bytes;
}

Count memory_gib() {
  const Count bytes = meminfo_bytes("MemTotal");
  const auto* const number = std::get_if<std::uint64_t>(&bytes);
  return number == nullptr ? bytes : Count((*number + kGib - 1) / kGib);
}

}  // namespace

CpuModel cpu_model_in(std::istream& cpuinfo) {
  const auto values = values_of(cpuinfo);
  const bool is_arm = values.contains("CPU implementer");
  const auto vendor = values.find(is_arm ? "CPU implementer" : "vendor_id");
  return {vendor == values.end() ? Unavailable{"/proc/cpuinfo names no vendor"}.text() : vendor->second,
          number_in(values, is_arm ? "CPU architecture" : "cpu family"),
          number_in(values, is_arm ? "CPU part" : "model"),
          number_in(values, is_arm ? "CPU revision" : "stepping")};
}

IdentityRecord identity_of(hwloc_topology_t topology) {
  std::ifstream cpuinfo("/proc/cpuinfo");
  const CpuModel cpu = cpu_model_in(cpuinfo);
  return {.vendor = cpu.vendor,
          .family = cpu.family,
          .model = cpu.model,
          .stepping = cpu.stepping,
          .cache_bytes = cache_bytes(topology),
          .memory_gib = memory_gib(),
          .kernel = kernel_name()};
}

}  // namespace podm::bench
