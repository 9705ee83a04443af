#pragma once

#include <chrono>
#include <cstdlib>

namespace podm::bench {

/// False if PODM_BENCH_UNTIMED is set. Tests of podm-bench set it: they compare no seconds, and need neither
/// warm memory nor repeated probes of the machine.
inline bool seconds_matter() { return std::getenv("PODM_BENCH_UNTIMED") == nullptr; }

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
