// The clock of processor time.
#pragma once

#include <ctime>

namespace podm {

/// Seconds that the calling thread has had a processor for: what others do to the machine counts less than in
/// time on the wall.
inline double processor_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace podm
