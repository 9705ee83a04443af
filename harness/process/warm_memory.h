// First touch of memory that a virtual machine's host has yet to provide is many times slower than first
// touch of other memory (0.4 GiB/s and 20 GiB/s were measured). A trial measures the mesher, not the host.
// Therefore a process touches memory and returns it before each trial.
#pragma once

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>

#include "process/stopwatch.h"

namespace podm::bench {

inline constexpr std::size_t kWarmBytes = std::size_t{1} << 30;

/// Touches the bytes in a separate process. The peak memory of this process, which its children inherit,
/// stays small.
inline void warm_memory(std::size_t bytes) {
  if (!seconds_matter()) return;
  const pid_t child = fork();
  if (child < 0) return;  // the trial then pays for the first touch
  if (child > 0) {
    waitpid(child, nullptr, 0);
    return;
  }
  void* const memory =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) _exit(1);
  madvise(memory, bytes, MADV_HUGEPAGE);
  for (std::size_t i = 0; i < bytes; i += 4096) static_cast<volatile char*>(memory)[i] = 1;
  _exit(0);
}

}  // namespace podm::bench
