// The time of one load that must wait for the load before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace podm::bench {

/// A cycle through all cache lines of a working set, in random order: no prefetcher foresees the next line.
/// Its memory is asked for in huge pages, so that addresses cost little beside the lines.
class PointerChase {
 public:
  static constexpr std::size_t kLineBytes = 64;

  /// `place` sees the memory before its first touch, to bind it to a node; it may throw. `bytes` is rounded
  /// down to lines, at least two. Throws std::bad_alloc.
  PointerChase(std::size_t bytes, std::uint64_t seed,
               const std::function<void(void*, std::size_t)>& place = {});
  ~PointerChase();
  PointerChase(const PointerChase&) = delete;
  PointerChase& operator=(const PointerChase&) = delete;

  /// Goes on from where it was.
  void walk(std::size_t num_loads);
  /// Processor time of so many loads, each; the clock is read twice.
  double seconds_per_load(std::size_t num_loads);

  std::size_t num_lines() const { return num_lines_; }
  /// Loads until the walk is back where it is: the number of lines.
  std::size_t cycle_length();
  /// The share of the memory that the kernel did give in huge pages.
  double huge_page_share() const;

 private:
  struct alignas(kLineBytes) Line {
    Line* next;
  };

  std::size_t mapped_bytes_, num_lines_;
  void* mapping_;
  Line* at_;
};

/// Clock cycles a second of the processor at work, by a chain of additions that take one cycle each.
double cycles_per_second();

}  // namespace podm::bench
