// The refinement queue of PDR.PODM (Feng et al., IMR 2015, Fig. 3). It selects the leaf that a computing node
// refines next.
//
// A leaf that is handed out is *active* until it is finished. Meanwhile no leaf within two rings of it (B1
// and B2, see octree.h) is handed out: these leaves are out of the queue, but they may still be given poor
// cells. The regions of active leaves are therefore disjoint. Leaves are handed out in one of these orders:
//   home       Only leaves of the node's own share of space, so that it works where it has worked. It waits
//              while none of them is ready. A node that has finished its share takes over half of the share
//              with most poor cells. Leaves with most poor cells come first, to a factor of two. Among such
//              leaves, the one with most leaves of other shares within two rings comes first, because they
//              would make it wait if it were left to the end. Leaves in the middle of a share are always
//              ready
//   most work  Leaves with most poor cells come first
//   Morton     Each node follows the curve from its last leaf; the nodes start evenly spread
//   coloring   By position modulo 3, color by color: leaves of one of the 27 colors do not block each other
// tests/test_refinement_queue_orders.cpp compares the orders and shows why home is the default.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <vector>

#include "octree/octree.h"

namespace podm {

enum class LeafOrder { kHome, kMostWork, kMorton, kColoring };

/// Any thread may call any function. The leaves handed out depend only on the order of the calls. Its only
/// lock is held for about ten microseconds per leaf; the refinement of a leaf takes milliseconds.
class RefinementQueue {
 public:
  /// Serves the nodes 0 to num_nodes - 1, at least one. The octree must outlive the queue. `wake(node)` must
  /// end the waiting of a node.
  RefinementQueue(
      const Octree& octree, unsigned num_nodes, LeafOrder order = LeafOrder::kHome,
      std::function<void(unsigned)> wake = [](unsigned) {});

  /// Gives each node a block of space with an equal share of the present poor cells, or of the leaves where
  /// there are none. Before, all leaves belong to the first node. A stop request leaves the shares unequal.
  void share_out(const std::stop_token& stop = {});

  /// Returns the node whose share has the leaf; 0 if there are no shares. No other thread may call anything
  /// meanwhile.
  std::size_t home_of(LeafId leaf) const { return share_of_[leaf]; }

  /// Adds `num_poor` poor cells to the leaf. Leaves that never had any are not handed out. The next finish()
  /// wakes the waiting nodes.
  void push(LeafId leaf, std::uint64_t num_poor);

  /// Returns a leaf for the node, now active, with all its poor cells taken. While every leaf with poor cells
  /// is near an active leaf, calls wait(), which returns when the node was woken or a stop is requested.
  /// Returns nothing if no leaf is active or has poor cells, or if `stop` was requested.
  template <class Wait>
  std::optional<LeafId> wait_and_pop(unsigned node, const Wait& wait, const std::stop_token& stop = {}) {
    for (;;) {
      const Popped popped = pop_or_wait(node, stop);
      if (!popped.must_wait) return popped.leaf;
      wait();
    }
  }
  /// Makes the leaf inactive. The caller must have pushed the poor cells that remain in it. Wakes the waiting
  /// nodes, beginning with the node after the leaf's own.
  void finish(LeafId leaf);

 private:
  friend class RefinementQueueState;  // read by tests: octree/tests/refinement_queue_state.h
  using Key = std::uint64_t;          // rank in the order, followed by the leaf

  struct Popped {
    std::optional<LeafId> leaf;
    bool must_wait;
  };
  Popped pop_or_wait(unsigned node, const std::stop_token& stop);
  void wake_all(unsigned first);
  Key key(LeafId leaf) const;
  std::set<Key>& ready_of(LeafId leaf) { return ready_[share_of_[leaf]]; }
  std::uint64_t home_rank(LeafId leaf) const;
  bool is_ready(LeafId leaf) const { return num_poor_[leaf] > 0 && num_active_near_[leaf] == 0; }
  std::vector<LeafId> buffer_zones(LeafId leaf) const;
  void set_active(const std::vector<LeafId>& zones, bool is_active);
  std::optional<LeafId> take(unsigned node);
  void move(LeafId leaf, std::size_t to);
  void divide(std::span<LeafId> leaves, std::size_t first_share, std::size_t num_shares,
              const std::stop_token& stop);
  std::size_t bisect(std::span<LeafId> leaves, double share) const;
  void count_rivals(const std::stop_token& stop);
  void take_over(unsigned node);

  const Octree& octree_;
  const LeafOrder order_;
  std::mutex mutex_;
  std::function<void(unsigned)> wake_;
  std::vector<bool> is_waiting_;          // indexed by node
  std::vector<unsigned> node_of_active_;  // indexed by leaf
  std::vector<std::uint64_t> num_poor_;
  std::vector<std::uint32_t> num_active_near_;  // active leaves within two rings, the leaf itself included
  std::vector<std::size_t> share_of_;           // indexed by leaf; one share per node for home, otherwise one
  std::vector<std::uint32_t> num_rivals_;       // leaves within two rings that share_out() gave to others
  std::vector<std::uint64_t> num_poor_of_share_;
  std::vector<std::set<Key>> ready_;  // indexed by share
  std::vector<Key> resume_at_;        // indexed by node: where the search for its next leaf starts
  std::size_t num_pending_ = 0;       // leaves with poor cells
  std::size_t num_active_ = 0;
  std::size_t num_waiting_ = 0;  // nodes to be woken
};

}  // namespace podm
