// The identity of a machine, beyond the name of its processor.
#pragma once

#include <hwloc.h>

#include <iosfwd>
#include <string>

#include "rows/machine_record.h"

namespace podm::bench {

/// Numbers that the vendor gives a processor.
struct CpuModel {
  std::string vendor;
  Count family = 0UL, model = 0UL, stepping = 0UL;
  bool operator==(const CpuModel&) const = default;
};

/// Reads the lines of /proc/cpuinfo, of x86 or of Arm.
CpuModel cpu_model_in(std::istream& cpuinfo);

/// If `topology` is null, the caches are unavailable.
IdentityRecord identity_of(hwloc_topology_t topology);

}  // namespace podm::bench
