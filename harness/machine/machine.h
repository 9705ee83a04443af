// The machine as hwloc sees it.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "rows/row.h"

namespace podm::bench {

struct Machine {
  MachineRecord summary;
  std::string topology_xml;  ///< hwloc's, without the host's name; empty when hwloc cannot tell
};

Machine this_machine();

/// "Linux 6.1.0 x86_64".
std::string kernel_name();

/// The bytes that /proc/meminfo lists under the key.
Count meminfo_bytes(const std::string& key);

/// The text after the colon of the first line "key : text"; empty when no line has the key.
std::string value_in(std::istream& lines, const std::string& key);
/// What value_in() finds in a file, or "unavailable: why".
std::string value_of(const std::string& path, const std::string& key);

}  // namespace podm::bench
