// Memory of this process and of the machine, in bytes, as Linux reports it.
#pragma once

#include <cstdint>

namespace podm::cli {

/// What can be had without swapping: the machine's, or the control group's where that is less.
std::uint64_t available_memory_bytes();

std::uint64_t resident_bytes();
/// The largest value resident_bytes() has had.
std::uint64_t peak_resident_bytes();

}  // namespace podm::cli
