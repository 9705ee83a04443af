// The poor cells of leaves. A cell belongs to the leaf that has its circumcentre.
//
// The cells of the initial mesh are distributed to leaves by all workers, slice by slice of the store. (Feng
// et al., IMR 2015, Fig. 3, lines 5, 6.) A leaf has them in the order of their ids, whoever listed them.
//
//   Workers meet at locks of leaves. A slice takes each of its leaves' locks once for all its cells there,
//   and is under them a sixth of its time where leaves are few, two fifths where they are many. (Of 3.3
//   million cells a slice has cells of 29 among 240 leaves, of 704 among 30,000.) So 256 workers hold 40 of
//   240 locks, or 110 of 1024: one is found taken at most one time in six. Nodes that end leaves hand their
//   cells over in the same way; they are fewer, and do so after milliseconds of refinement. Leaves of equal
//   number modulo 1024 share a lock, so that a leaf takes no memory for one. What is left over has a lock of
//   its own, taken when a leaf ends.
#pragma once

#include <mutex>
#include <span>
#include <stop_token>
#include <vector>

#include "delaunay/relocation.h"
#include "octree/refinement_queue.h"
#include "refine/poor_element_list.h"

namespace podm {

/// Any thread may call any of it, unless it says otherwise.
class LeafCells {
 public:
  using Entries = std::vector<PoorElementList::Entry>;
  static constexpr CellId kSlice = 4096;  // cells

  /// The store's cells of this moment are to be distributed, or not; or `only` these, which live.
  LeafCells(const Mesh& mesh, const Octree& octree, const Entries* only = nullptr);

  std::size_t num_slices() const { return outside_.size(); }
  /// Lists the living cells of a slice with their leaves, and returns how many. Each slice is
  /// distributed once, in any order, and meanwhile no cell changes.
  std::size_t distribute(std::size_t slice);
  /// Tells the queue of all cells that have been distributed, and shares them out. Nobody else may call
  /// anything meanwhile. A stop request ends it.
  void share_out(RefinementQueue& queue, const std::stop_token& stop) const;

  /// Lists cells with their leaves, and tells the queue. Nobody may change them meanwhile. After a stop
  /// request it lists no more.
  void add(const Entries& cells, RefinementQueue& queue, const std::stop_token& stop);
  /// Follows cells that have moved since they were distributed, and returns how many it looked at: one of
  /// `num_parts` parts of them, each to be followed by one worker. No leaf has begun.
  std::size_t rename(const Relocation& relocation, std::size_t part, std::size_t num_parts);
  /// Lists cells that no leaf can refine.
  void defer(const Entries& cells);
  /// Those distributed come first, by their ids.
  Entries take(LeafId leaf);
  /// Deferred cells and those that are in no leaf. Nobody else may call anything meanwhile.
  Entries take_leftover();

 private:
  struct List {
    Entries entries;
    std::size_t num_distributed = 0;  // the first entries, in any order
  };
  // In a cache line of its own.
  struct alignas(64) Lock {
    std::mutex mutex;
  };

  using Key = std::uint64_t;  // leaf << 32 | place among the cells
  Entries living_of(std::size_t slice) const;
  template <class Action>
  void for_each_leaf(const Entries& cells, Action&& action) const;
  static void append(const Entries& cells, std::span<const Key> keys, Entries& to);
  std::mutex& mutex_of(LeafId leaf) { return locks_[leaf % locks_.size()].mutex; }

  const Mesh& mesh_;
  const Octree& octree_;
  const Entries* const only_;      // none: all cells of the store
  const CellId bound_;             // so many places of cells are looked at
  std::vector<Entries> outside_;   // indexed by slice: its cells in no leaf
  std::vector<Lock> locks_{1024};  // each guards the lists of some leaves
  std::vector<List> list_of_leaf_;
  std::mutex leftover_mutex_;
  Entries leftover_;
};

}  // namespace podm
