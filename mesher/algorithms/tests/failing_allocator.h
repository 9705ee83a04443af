// The allocator of a test program, which runs dry once, at the moment a test chooses.
#pragma once

#include <atomic>
#include <cstdint>

namespace podm::test {

/// Allocations until one fails; negative: none will.
extern std::atomic<std::int64_t> allocations_left;

}  // namespace podm::test
