// Threads of a test program, of which one cannot be started, at the moment a test chooses.
#pragma once

#include <atomic>

namespace podm::test {

/// Threads that start until one does not; negative: all do.
extern std::atomic<int> threads_left;

}  // namespace podm::test
