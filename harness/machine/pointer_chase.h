// Measures the time of a load that must wait for the load before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace podm::bench {

/// A cycle through all cache lines of a working set in random order. No prefetcher can predict the next line.
/// Its memory is requested in huge pages, so that address translation costs little compared with the lines.
class PointerChase {
 public:
  static constexpr std::size_t kLineBytes = 64;

  /// Calls `place` with the memory before its first touch, to bind it to a node; `place` may throw. `bytes`
  /// is rounded down to whole lines, at least two. Throws std::bad_alloc.
  PointerChase(std::size_t bytes, std::uint64_t seed,
               const std::function<void(void*, std::size_t)>& place = {});
  ~PointerChase();
  PointerChase(const PointerChase&) = delete;
  PointerChase& operator=(const PointerChase&) = delete;

  /// Continues from the current line.
  void walk(std::size_t num_loads);
  /// Returns the processor time per load over this number of loads. The clock is read twice.
  double seconds_per_load(std::size_t num_loads);

  std::size_t num_lines() const { return num_lines_; }
  /// Returns the number of loads until the walk is back at the current line, which is the number of lines.
  std::size_t cycle_length();
  /// Returns the share of the memory that the kernel provided in huge pages.
  double huge_page_share() const;

 private:
  struct alignas(kLineBytes) Line {
    Line* next;
  };

  std::size_t mapped_bytes_, num_lines_;
  void* mapping_;
  Line* at_;
};

/// Returns the clock cycles per second of the busy processor, measured by a chain of additions of one cycle
/// each.
double cycles_per_second();

}  // namespace podm::bench
