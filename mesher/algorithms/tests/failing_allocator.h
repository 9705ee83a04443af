// The allocator of a test program. It fails once, at the moment that a test chooses.
#pragma once

#include <atomic>
#include <cstdint>

namespace podm::test {

/// The number of allocations until one fails; negative: none fails.
extern std::atomic<std::int64_t> allocations_left;

}  // namespace podm::test
