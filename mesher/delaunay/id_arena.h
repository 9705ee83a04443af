// Ids handed out in blocks. On a machine with several NUMA nodes each node has its own runs of ids. The data
// that one run indexes fills whole huge pages: first touch then puts a cell in its maker's memory, and the id
// identifies the node.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "delaunay/shared_ids.h"
#include "runtime/access_tally.h"

namespace podm {

class IdArena {
 public:
  /// Manages the ids below `capacity`. A run has 2^run_bits ids. Blocks are taken from runs; none is larger
  /// than a run. If there are shared ids, the arena takes its own from them and returns them in the end.
  IdArena(std::size_t capacity, int num_nodes, unsigned run_bits, SharedIds* shared = nullptr)
      : num_ids_(capacity),
        capacity_(capacity),
        run_bits_(run_bits),
        shared_(shared),
        nodes_(static_cast<std::size_t>(num_nodes)) {
    if (num_nodes > 1) node_of_run_.resize((capacity >> run_bits) + 1);
  }
  ~IdArena() {
    if (shared_ != nullptr) shared_->add(bound() + num_kept_back_);
  }
  IdArena(const IdArena&) = delete;
  IdArena& operator=(const IdArena&) = delete;

  /// Returns the number of ids that each of `num_workers` workers should take at once. Unused ids in blocks
  /// are then at most 1/32 of all, unless the minimum block size applies.
  std::uint32_t block_for(std::size_t num_workers) const {
    constexpr std::size_t kLeast = 8, kMost = 1024, kBlocksPerWorker = 32;
    const std::size_t longest = node_of_run_.empty() ? kMost : std::min(kMost, std::size_t{1} << run_bits_);
    return static_cast<std::uint32_t>(
        std::clamp(capacity_ / (kBlocksPerWorker * num_workers), std::min(kLeast, longest), longest));
  }
  /// Takes a block of `count` ids and returns the first. Any worker may call it at any time: the mutex is
  /// taken about once per thousand cells. Throws std::bad_alloc when the capacity is used up.
  std::uint32_t take(std::uint32_t count, NodeIndex node) {
    const std::scoped_lock lock(mutex_);
    OfNode& own = nodes_[node];
    if (own.end - own.next < count) start_run(count, node);
    own.next += count;
    return own.next - count;
  }
  /// Reduces the number of ids that may be taken by `count`, and replaces any earlier reduction. Returns
  /// false if more are taken already.
  bool reduce_capacity(std::size_t count) {
    const std::scoped_lock lock(mutex_);
    capacity_ = num_ids_ - std::min(num_ids_, count);
    if (shared_ != nullptr && !keep_back(num_ids_ - capacity_)) capacity_ = 0;
    return bound() <= capacity_;
  }
  /// True if more ids were requested than there were.
  bool is_exhausted() const { return is_exhausted_.load(std::memory_order_relaxed); }
  /// Returns unused ids of any node to the arena; takes them out of `ids` one by one. Throws std::bad_alloc.
  void give_back(std::vector<std::uint32_t>& ids) {
    const std::scoped_lock lock(mutex_);
    for (; !ids.empty(); ids.pop_back()) nodes_[node_of(ids.back())].returned.push_back(ids.back());
  }
  /// Adds at most `count` returned ids of the node to `ids`, which has room. Returns false if there are none.
  bool take_returned(std::uint32_t count, NodeIndex node, std::vector<std::uint32_t>& ids) {
    const std::scoped_lock lock(mutex_);
    auto& returned = nodes_[node].returned;
    const auto from = returned.end() - std::min<std::ptrdiff_t>(count, std::ssize(returned));
    ids.insert(ids.end(), from, returned.end());
    const bool is_any = from != returned.end();
    returned.erase(from, returned.end());
    return is_any;
  }
  NodeIndex node_of(std::uint32_t id) const {
    return node_of_run_.empty() ? NodeIndex{0} : node_of_run_[id >> run_bits_];
  }
  int num_nodes() const { return static_cast<int>(nodes_.size()); }
  /// Ids below it have been handed out or belong to the run of a node.
  std::uint32_t bound() const { return bound_.load(std::memory_order_relaxed); }

 private:
  struct OfNode {
    std::uint32_t next = 0, end = 0;
    std::vector<std::uint32_t> returned{};
  };
  bool keep_back(std::size_t count) {
    shared_->add(std::exchange(num_kept_back_, 0));
    if (!shared_->take(count)) return false;
    num_kept_back_ = count;
    return true;
  }
  void start_run(std::uint32_t count, NodeIndex node) {
    const std::uint32_t first = bound();
    const std::uint32_t size = node_of_run_.empty() ? count : 1u << run_bits_;
    if (first + static_cast<std::size_t>(size) > capacity_) {
      is_exhausted_.store(true, std::memory_order_relaxed);
      throw std::bad_alloc();
    }
    if (shared_ != nullptr && !shared_->take(size)) throw std::bad_alloc();
    if (!node_of_run_.empty()) node_of_run_[first >> run_bits_] = node;
    bound_.store(first + size, std::memory_order_relaxed);
    nodes_[node].next = first;
    nodes_[node].end = first + size;
  }

  std::size_t num_ids_, capacity_;  // the ids between them may not be taken
  unsigned run_bits_;
  SharedIds* const shared_;        // null: the arena has its ids alone
  std::size_t num_kept_back_ = 0;  // shared ids that may not be taken
  std::mutex mutex_;
  std::vector<OfNode> nodes_;
  std::vector<NodeIndex> node_of_run_;  // empty on one node
  // Relaxed: an id is handed on under locks, or with a list entry under a mutex.
  std::atomic<std::uint32_t> bound_ = 0;
  std::atomic<bool> is_exhausted_ = false;
};

}  // namespace podm
