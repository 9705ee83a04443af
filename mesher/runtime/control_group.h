// The control groups that this process is in (cgroups(7), versions 1 and 2): the limits set by a batch
// system, a container or systemd.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace podm {

/// The place of a controller's limits.
struct ControlGroup {
  std::vector<std::string> folders;  ///< from the process's own group outwards; empty: no such controller
  bool is_unified = false;           ///< version 2, whose files have other names
};

/// `controller` is "memory", "cpu" or "cpuset". `root` is prefixed to /proc and /sys, for trees recorded
/// elsewhere.
ControlGroup control_group_of(const std::string& controller, const std::string& root = "");

/// More bytes than any limit.
inline constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// Returns the least of the groups' limits; kNoLimit if none has one. Version 2 has two limits, memory.high
/// and memory.max.
std::uint64_t memory_limit_of_control_groups(const std::string& root = "");
/// Returns the least number of bytes that any of the groups still grants. Pages of files that can be dropped
/// do not count as used. kNoLimit if no group has a limit.
std::uint64_t memory_left_in_control_groups(const std::string& root = "");

}  // namespace podm
