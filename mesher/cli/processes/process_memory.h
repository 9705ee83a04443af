// Memory of this process and of the machine, in bytes, as Linux reports it.
#pragma once

#include <cstdint>

namespace podm::cli {

/// Returns the memory available without swapping: that of the machine, or that of the control group if it is
/// less.
std::uint64_t available_memory_bytes();

std::uint64_t resident_bytes();
/// Returns the largest value that resident_bytes() has had.
std::uint64_t peak_resident_bytes();

}  // namespace podm::cli
