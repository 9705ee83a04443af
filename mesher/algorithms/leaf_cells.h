// The poor cells of leaves. A cell belongs to the leaf that contains its circumcenter.
//
// All workers distribute the cells of the initial mesh to the leaves, slice by slice of the store. (Feng et
// al., IMR 2015, Fig. 3, lines 5, 6.) A leaf has these cells in the order of their ids, no matter which
// worker listed them.
//
//   Workers contend for the locks of leaves. A slice takes the lock of each of its leaves once for all its
//   cells there. It holds locks for a sixth of its time where leaves are few, and for two fifths where they
//   are many. (In a mesh of 3.3 million cells, a slice has cells of 29 among 240 leaves, or of 704 among
//   30,000.) Therefore 256 workers hold 40 of 240 locks, or 110 of 1024, and a lock is found taken at most
//   one time in six. Nodes that end leaves hand their cells over in the same way; they are fewer, and do so
//   after milliseconds of refinement. Leaves with equal numbers modulo 1024 share a lock, so that a leaf
//   needs no memory for one. Leftover cells have a lock of their own, which is taken when a leaf ends.
#pragma once

#include <mutex>
#include <span>
#include <stop_token>
#include <vector>

#include "delaunay/relocation.h"
#include "octree/refinement_queue.h"
#include "refine/poor_element_list.h"

namespace podm {

/// Any thread may call any function, except where noted.
class LeafCells {
 public:
  using Entries = std::vector<PoorElementList::Entry>;
  static constexpr CellId kSlice = 4096;  // cells

  /// Prepares the distribution of the store's present cells, or of the living cells `only`. It may be
  /// omitted.
  LeafCells(const Mesh& mesh, const Octree& octree, const Entries* only = nullptr);

  LeafId num_leaves() const { return static_cast<LeafId>(list_of_leaf_.size()); }
  std::size_t num_slices() const { return outside_.size(); }
  /// Lists the living cells of a slice with their leaves, and returns their number. Each slice is distributed
  /// once, in any order, and no cell changes meanwhile.
  std::size_t distribute(std::size_t slice);
  /// Adds the numbers of distributed cells to the queue and makes the queue share the leaves out. No other
  /// call may be made meanwhile. A stop request ends it.
  void share_out(RefinementQueue& queue, const std::stop_token& stop) const;

  /// Lists cells with their leaves, and adds their numbers to the queue. The cells must not change meanwhile.
  /// After a stop request no more cells are listed.
  void add(const Entries& cells, RefinementQueue& queue, const std::stop_token& stop);
  /// Updates cells that have moved since they were distributed, and returns the number of cells examined.
  /// Handles one of `num_parts` parts, each of which belongs to one worker. No leaf has begun.
  std::size_t rename(const Relocation& relocation, std::size_t part, std::size_t num_parts);
  /// Lists cells that no leaf can refine.
  void defer(const Entries& cells);
  /// Returns the leaf's cells. Distributed cells come first, by id.
  Entries take(LeafId leaf);
  /// Returns the deferred cells and those in no leaf. No other call may be made meanwhile.
  Entries take_leftover();

 private:
  struct List {
    Entries entries;
    std::size_t num_distributed = 0;  // the first entries, in any order
  };
  // A mutex in a cache line of its own.
  struct alignas(64) Lock {
    std::mutex mutex;
  };

  using Key = std::uint64_t;  // leaf << 32 | position among the cells
  Entries living_of(std::size_t slice) const;
  template <class Action>
  void for_each_leaf(const Entries& cells, Action&& action) const;
  static void append(const Entries& cells, std::span<const Key> keys, Entries& to);
  std::mutex& mutex_of(LeafId leaf) { return locks_[leaf % locks_.size()].mutex; }

  const Mesh& mesh_;
  const Octree& octree_;
  const Entries* const only_;      // none: all cells of the store
  const CellId bound_;             // end of the range of cells that slices cover
  std::vector<Entries> outside_;   // indexed by slice: its cells in no leaf
  std::vector<Lock> locks_{1024};  // each guards the lists of some leaves
  std::vector<List> list_of_leaf_;
  std::mutex leftover_mutex_;
  Entries leftover_;
};

}  // namespace podm
