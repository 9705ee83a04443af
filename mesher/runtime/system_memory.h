// The machine's memory, and memory that this process has freed.
#pragma once

#include <cstdint>

namespace podm {

/// Returns the bytes of memory of the machine.
std::uint64_t physical_memory_bytes();

/// Returns the bytes of address space that this process may have; the largest number if there is no limit.
std::uint64_t address_space_bytes();

/// Makes freed memory that the allocator holds back available to other threads and programs, where the
/// allocator can.
void return_free_memory();

}  // namespace podm
