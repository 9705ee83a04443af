#pragma once

#include <chrono>

namespace podm::bench {

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
