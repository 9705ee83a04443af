// The poor element list (PEL): cells that may break a rule, last in first out. Entries are classified only
// when their turn comes; by then most have died, which their stamp shows. Last-in-first-out keeps the work
// where the cache is warm.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"

namespace podm {

class PoorElementList {
 public:
  struct Entry {
    CellId cell;
    std::uint16_t stamp;
  };
  /// It is a worker's, on a store of so many cells.
  explicit PoorElementList(std::size_t cell_capacity)
      : first_cleaning_(std::min(kFirstCleaning, cell_capacity / kCellsAnEntry)) {}
  /// Bytes that the lists of so many workers take at most beside entries of live cells: they hold stale ones
  /// too.
  static std::size_t stale_bytes(std::size_t cell_capacity, std::size_t num_workers) {
    return num_workers * 2 * sizeof(Entry) * std::min(kFirstCleaning, cell_capacity / kCellsAnEntry);
  }

  void push(CellId cell, std::uint16_t stamp) { entries_.push_back({cell, stamp}); }
  /// Most entries at the bottom are stale. Dropping them whenever the list has doubled keeps it short.
  bool is_due_for_cleaning() const { return entries_.size() >= next_cleaning_; }
  void drop_stale(const Mesh& mesh) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      mesh.prefetch(entries_[std::min(i + kLookahead, entries_.size() - 1)].cell);
      if (mesh.stamp(entries_[i].cell) == entries_[i].stamp) entries_[kept++] = entries_[i];
    }
    entries_.resize(kept);
    next_cleaning_ = std::max(first_cleaning_, 2 * entries_.size());
  }
  /// Removes the older half, of which the live entries are returned, at most `max`.
  std::vector<Entry> take_oldest(std::size_t max, const Mesh& mesh) {
    std::vector<Entry> taken;
    std::size_t scanned = 0;
    for (; scanned < entries_.size() / 2 && taken.size() < max; ++scanned) {
      if (mesh.stamp(entries_[scanned].cell) == entries_[scanned].stamp) taken.push_back(entries_[scanned]);
    }
    entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(scanned));
    return taken;
  }
  bool is_empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  /// The cell whose turn comes `turns` from now, to be prefetched; the list must not be empty.
  CellId upcoming(std::size_t turns) const {
    return entries_[entries_.size() > turns ? entries_.size() - 1 - turns : 0].cell;
  }
  Entry pop() {
    const Entry last = entries_.back();
    entries_.pop_back();
    return last;
  }

 private:
  // A list that is not due for its first cleaning is short, in a small store too.
  static constexpr std::size_t kLookahead = 16;  // in a scan, whose cells lie anywhere
  static constexpr std::size_t kFirstCleaning = 1 << 16, kCellsAnEntry = 64;
  std::size_t first_cleaning_;
  std::vector<Entry> entries_;
  std::size_t next_cleaning_ = first_cleaning_;
};

}  // namespace podm
