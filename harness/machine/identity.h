// The identity of a machine, beyond the name of its processor.
#pragma once

#include <hwloc.h>

#include <array>
#include <cstdint>
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

/// The registers eax, ebx, ecx and edx that a CPUID leaf fills.
using CpuidLeaf = std::array<std::uint32_t, 4>;

/// Decodes leaves 0 and 1 of CPUID. Extended family and model are added by the rule that the vendors share.
CpuModel decode_cpuid(const CpuidLeaf& leaf_0, const CpuidLeaf& leaf_1);

/// Reads the lines of /proc/cpuinfo, of x86 or of Arm.
CpuModel cpu_model_in(std::istream& cpuinfo);

/// Uses CPUID on x86 and /proc/cpuinfo elsewhere.
CpuModel this_cpu_model();

/// If `topology` is null, the caches are unavailable.
IdentityRecord identity_of(hwloc_topology_t topology);

}  // namespace podm::bench
