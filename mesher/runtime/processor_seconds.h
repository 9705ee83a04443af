// The clock of processor time.
#pragma once

#include <ctime>

namespace podm {

/// Returns the seconds for which the calling thread has had a processor. Other load on the machine affects
/// this less than wall-clock time.
inline double processor_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace podm
