// The refinement queue of PDR.PODM (Feng et al., IMR 2015, Fig. 3): which leaf a computing node refines next.
//
// A leaf that is handed out is *active* until it is finished. Meanwhile no leaf within two rings of it (B1
// and B2, see octree.h) is handed out: they are out of the queue, though they may be given poor cells. So the
// regions of active leaves are disjoint. Orders in which leaves are handed out:
//   home       of the node's own share of space alone, so that it works where it has worked; while none of it
//              is ready the node waits. One that is through with its share takes over half of the one that
//              has most poor cells. Most poor cells first, to a factor of two; among such the leaf that has
//              most leaves of others' shares within two rings, which keep it waiting if it is left to the
//              end. Leaves in the middle of a share are ready whenever its node asks
//   most work  most poor cells first
//   Morton     each node goes along the curve from its last leaf; nodes start evenly spread
//   coloring   by position modulo 3, colour by colour: leaves of one of the 27 do not keep each other waiting
// tests/test_refinement_queue_orders.cpp compares them, and tells why home is the default.
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

/// Any thread may call any of it. What it hands out depends on the order of the calls alone. Its one lock is
/// held for some ten microseconds a leaf, whose refinement takes milliseconds.
class RefinementQueue {
 public:
  /// It serves nodes 0 to num_nodes - 1, at least one. The octree must outlive the queue. `wake(node)` ends
  /// the waiting of a node.
  RefinementQueue(
      const Octree& octree, unsigned num_nodes, LeafOrder order = LeafOrder::kHome,
      std::function<void(unsigned)> wake = [](unsigned) {});

  /// Gives each node a block of space that has an equal share of the poor cells there are now, or of the
  /// leaves where there are none; until then all are the first node's. A stop request leaves the shares
  /// unequal.
  void share_out(const std::stop_token& stop = {});

  /// The node whose share has the leaf; 0 where there are no shares. Nobody else may call anything meanwhile.
  std::size_t home_of(LeafId leaf) const { return share_of_[leaf]; }

  /// The leaf has `num_poor` more poor cells. Leaves that never had any are not handed out. Nodes that wait
  /// are told at the next finish().
  void push(LeafId leaf, std::uint64_t num_poor);

  /// A leaf for the node, now active, with all its poor cells taken. While all that have poor cells are near
  /// active ones it waits, by wait(), which returns when the node was woken or a stop is requested. Nothing:
  /// no leaf is active nor has poor cells, or `stop` was requested.
  template <class Wait>
  std::optional<LeafId> wait_and_pop(unsigned node, const Wait& wait, const std::stop_token& stop = {}) {
    for (;;) {
      const Popped popped = pop_or_wait(node, stop);
      if (!popped.must_wait) return popped.leaf;
      wait();
    }
  }
  /// The leaf is active no more. Whoever has it must have pushed what it left behind. Wakes the nodes that
  /// wait, that after its own first.
  void finish(LeafId leaf);

 private:
  friend class RefinementQueueState;  // what tests see of it: octree/tests/refinement_queue_state.h
  using Key = std::uint64_t;          // rank in the order, then leaf

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
  std::vector<std::size_t> share_of_;           // indexed by leaf; there is one a node for home, else one
  std::vector<std::uint32_t> num_rivals_;       // leaves within two rings that were shared out to others
  std::vector<std::uint64_t> num_poor_of_share_;
  std::vector<std::set<Key>> ready_;  // indexed by share
  std::vector<Key> resume_at_;        // indexed by node: where in the order its next leaf is looked for
  std::size_t num_pending_ = 0;       // leaves with poor cells
  std::size_t num_active_ = 0;
  std::size_t num_waiting_ = 0;  // nodes that are to be woken
};

}  // namespace podm
