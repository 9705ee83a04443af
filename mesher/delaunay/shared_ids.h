// Ids that several stores may take together: ranks of one process share its memory by need.
#pragma once

#include <atomic>
#include <cstdint>

namespace podm {

class SharedIds {
 public:
  void add(std::uint64_t count) { left_.fetch_add(count, std::memory_order_relaxed); }
  /// Takes all of the ids, or none. Returns false if fewer are left.
  bool take(std::uint64_t count) {
    std::uint64_t left = left_.load(std::memory_order_relaxed);
    while (left >= count)
      if (left_.compare_exchange_weak(left, left - count, std::memory_order_relaxed)) return true;
    return false;
  }

 private:
  std::atomic<std::uint64_t> left_ = 0;  // relaxed: it counts ids, and guards no other data
};

}  // namespace podm
