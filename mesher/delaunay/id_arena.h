// Ids handed out in blocks. On a machine of several NUMA nodes each node has runs of ids of its own, so long
// that what they index fills whole huge pages: first touch then puts a cell in its maker's memory, and an id
// tells whose it is.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <new>
#include <vector>

namespace podm {

using NodeIndex = std::uint16_t;  // of a NUMA node, from 0

class IdArena {
 public:
  /// Ids below `capacity`. 2^run_bits ids make a run, of which blocks are taken.
  IdArena(std::size_t capacity, int num_nodes, unsigned run_bits)
      : capacity_(capacity), run_bits_(run_bits), cursors_(static_cast<std::size_t>(num_nodes)) {
    if (num_nodes > 1) node_of_run_.resize((capacity >> run_bits) + 1);
  }

  /// A block of `count` ids; returns the first. Any worker, any time: the mutex is taken once in a thousand
  /// cells. Throws std::bad_alloc when the capacity is used up.
  std::uint32_t take(std::uint32_t count, NodeIndex node) {
    const std::scoped_lock lock(mutex_);
    Cursor& cursor = cursors_[node];
    if (cursor.end - cursor.next < count) cursor = next_run(count, node);
    cursor.next += count;
    return cursor.next - count;
  }
  NodeIndex node_of(std::uint32_t id) const {
    return node_of_run_.empty() ? NodeIndex{0} : node_of_run_[id >> run_bits_];
  }
  int num_nodes() const { return static_cast<int>(cursors_.size()); }
  /// Ids below it have been handed out, or lie in the run of a node.
  std::uint32_t bound() const { return bound_.load(std::memory_order_relaxed); }

 private:
  struct Cursor {
    std::uint32_t next = 0, end = 0;
  };
  Cursor next_run(std::uint32_t count, NodeIndex node) {
    const std::uint32_t first = bound();
    const std::uint32_t size = node_of_run_.empty() ? count : 1u << run_bits_;
    if (first + static_cast<std::size_t>(size) > capacity_) throw std::bad_alloc();
    if (!node_of_run_.empty()) node_of_run_[first >> run_bits_] = node;
    bound_.store(first + size, std::memory_order_relaxed);
    return {first, first + size};
  }

  std::size_t capacity_;
  unsigned run_bits_;
  std::mutex mutex_;
  std::vector<Cursor> cursors_;
  std::vector<NodeIndex> node_of_run_;  // empty on one node
  // Relaxed: an id is handed on under locks, or with a list entry under a mutex.
  std::atomic<std::uint32_t> bound_ = 0;
};

}  // namespace podm
