// Threads of a test program. One cannot be started, at the moment that a test chooses.
#pragma once

#include <atomic>

namespace podm::test {

/// The number of threads that start until one does not; negative: all start.
extern std::atomic<int> threads_left;

}  // namespace podm::test
