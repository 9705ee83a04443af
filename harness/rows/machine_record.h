// Records of a machine: the processor and its environment, which stay the same, and its speed, which drifts.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "rows/mesher_record.h"

namespace podm::bench {

/// Identifies a kind of machine beyond the processor's name, which virtual machines shorten to that of a
/// family. A field that the system does not report reads "unavailable: why".
struct IdentityRecord {
  std::string vendor;                                                 ///< "GenuineIntel"
  Count family = 0UL, model = 0UL, stepping = 0UL;                    ///< with the extended parts added
  std::variant<ByName<std::uint64_t>, Unavailable> cache_bytes = {};  ///< data caches: "L1", "L2", ...
  Count memory_gib = 0UL;  ///< rounded up; the kernel reserves a varying part of the last one
  std::string kernel;      ///< "Linux 6.1.0 x86_64"
  static constexpr auto fields() {
    return PODM_FIELDS(IdentityRecord, vendor, family, model, stepping, cache_bytes, memory_gib, kernel);
  }
  bool operator==(const IdentityRecord&) const = default;
};

/// The speed of one processor at one moment (machine/probe.h).
struct ProbeRecord {
  double chase_ns = 0;        ///< a load that waits for the load before it, in random order
  double triad_gb_per_s = 0;  ///< bytes of a[i] = b[i] + s c[i] per second, 1e9
  double integer_ns = 0;      ///< an addition that waits for the addition before it
  static constexpr auto fields() { return PODM_FIELDS(ProbeRecord, chase_ns, triad_gb_per_s, integer_ns); }
  bool operator==(const ProbeRecord&) const = default;
};
using Probe = std::variant<ProbeRecord, Unavailable>;

/// The machine, without the host's name or state. Two rows are of the same machine if all members are equal.
/// A ratio of such rows compares programs and options alone, under one kernel.
struct MachineRecord {
  std::string cpu;
  Count packages = 0UL, numa_nodes = 0UL, cores = 0UL, processors = 0UL;
  int usable_processors = 0;
  std::optional<IdentityRecord> identity;  ///< rows from before November 2026 have none
  static constexpr auto fields() {
    return PODM_FIELDS(MachineRecord, cpu, packages, numa_nodes, cores, processors, usable_processors,
                       (identity));
  }
  bool operator==(const MachineRecord&) const = default;
};

}  // namespace podm::bench
