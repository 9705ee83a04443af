// What kind of machine this is, beyond the name that its processor gives.
#pragma once

#include <hwloc.h>

#include <array>
#include <cstdint>
#include <iosfwd>
#include <string>

#include "rows/machine_record.h"

namespace podm::bench {

/// The maker's numbers of a processor.
struct CpuModel {
  std::string vendor;
  Count family = 0UL, model = 0UL, stepping = 0UL;
  bool operator==(const CpuModel&) const = default;
};

/// The registers eax, ebx, ecx and edx that a leaf of CPUID fills.
using CpuidLeaf = std::array<std::uint32_t, 4>;

/// From leaves 0 and 1 of CPUID: the extended family and model are added by the rule that the makers share.
CpuModel decode_cpuid(const CpuidLeaf& leaf_0, const CpuidLeaf& leaf_1);

/// From the lines of /proc/cpuinfo, of x86 or of Arm.
CpuModel cpu_model_in(std::istream& cpuinfo);

/// From CPUID on x86, from /proc/cpuinfo elsewhere.
CpuModel this_cpu_model();

/// `topology` may be null: then the caches are unavailable.
IdentityRecord identity_of(hwloc_topology_t topology);

}  // namespace podm::bench
