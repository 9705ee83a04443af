// Memory that a virtual machine's host has yet to provide costs a process many times what other memory costs
// at its first touch (0.4 GiB/s against 20 GiB/s were seen). A trial measures the mesher, not that: before
// each, a process touches memory and gives it back.
#pragma once

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>

namespace podm::bench {

inline constexpr std::size_t kWarmBytes = std::size_t{1} << 30;

/// Touches the bytes in a process of its own, so that the peak memory of this one, which its children
/// inherit, stays small.
inline void warm_memory(std::size_t bytes) {
  const pid_t child = fork();
  if (child < 0) return;  // then the trial pays for itself
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
