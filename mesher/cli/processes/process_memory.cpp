#include "cli/processes/process_memory.h"

#include <algorithm>
#include <fstream>
#include <string>

#include "podm/errors.h"
#include "runtime/control_group.h"

namespace podm::cli {
namespace {

// Returns the value of a line "Key:   123 kB".
std::uint64_t read_kib_as_bytes(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line))
    if (line.starts_with(key + ":")) return 1024 * std::stoull(line.substr(key.size() + 1));
  throw InternalError(path + " has no line " + key);
}

}  // namespace

std::uint64_t available_memory_bytes() {
  return std::min(read_kib_as_bytes("/proc/meminfo", "MemAvailable"), memory_left_in_control_groups());
}

std::uint64_t resident_bytes() { return read_kib_as_bytes("/proc/self/status", "VmRSS"); }

// Does not use getrusage: its maximum survives exec and would include the memory of a large parent.
std::uint64_t peak_resident_bytes() { return read_kib_as_bytes("/proc/self/status", "VmHWM"); }

}  // namespace podm::cli
