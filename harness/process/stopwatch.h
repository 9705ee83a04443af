#pragma once

#include <chrono>
#include <cstdlib>

namespace podm::bench {

/// False in tests of the program, which set the variable: they do not compare seconds, and need no warm
/// memory and no second probe of the machine.
inline bool seconds_count() { return std::getenv("PODM_BENCH_UNTIMED") == nullptr; }

class Stopwatch {
 public:
  /// Returns the seconds since construction.
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace podm::bench
