// The control groups that this process is in (cgroups(7), versions 1 and 2): what a batch system, a container
// or systemd lets it use.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace podm {

/// Where a controller's limits stand.
struct ControlGroup {
  std::vector<std::string>
      folders;              ///< of the process's own group, then of those around it; none: no such controller
  bool is_unified = false;  ///< version 2, whose files have other names
};

/// `controller` is "memory", "cpu" or "cpuset". `root` stands before /proc and /sys, for trees recorded
/// elsewhere.
ControlGroup control_group_of(const std::string& controller, const std::string& root = "");

/// More bytes than any limit.
inline constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// The least of the groups' limits; kNoLimit where none has one. Version 2 has
/// two limits, memory.high and memory.max.
std::uint64_t memory_limit_of_control_groups(const std::string& root = "");
/// Bytes that the groups still grant, the least of them; pages of files that can be dropped are not counted
/// as used. kNoLimit where none has a limit.
std::uint64_t memory_left_in_control_groups(const std::string& root = "");

}  // namespace podm
