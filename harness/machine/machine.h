// The machine as hwloc reports it.
#pragma once

#include <iosfwd>
#include <string>

#include "rows/row.h"

namespace podm::bench {

struct Machine {
  MachineRecord summary;
  std::string topology_xml;  ///< from hwloc, without the host name; empty when hwloc fails
};

Machine this_machine();

/// "Linux 6.1.0 x86_64".
std::string kernel_name();

/// Returns the bytes that /proc/meminfo lists under the key.
Count meminfo_bytes(const std::string& key);

/// Returns the text after the colon of the first line "key : text"; empty when no line has the key.
std::string value_in(std::istream& lines, const std::string& key);
/// Returns the result of value_in() for a file, or "unavailable: why".
std::string value_of(const std::string& path, const std::string& key);

}  // namespace podm::bench
