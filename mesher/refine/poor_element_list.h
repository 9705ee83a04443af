// The poor element list (PEL): cells that may violate a rule, last in first out. Entries are classified only
// when their turn comes. Most of their cells have died by then, which the stamp shows. Last in first out
// keeps the work where the cache is warm.
//
// In the middle of a run the list is as long as the store; at the end it is empty. It therefore consists of
// chunks, which are given back as the list shrinks, and the store grows into their memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "runtime/mapped_chunk.h"

namespace podm {

class PoorElementList {
 public:
  /// Six bytes: an aligned cell id would lengthen every list by a third.
  struct [[gnu::packed, gnu::aligned(2)]] Entry {
    CellId cell;
    std::uint16_t stamp;
  };
  /// The list is cleaned when it has grown by this factor since the last cleaning.
  static constexpr std::size_t kGrowth = 3;
  /// Makes the list of one worker, for a store of `cell_capacity` cells.
  explicit PoorElementList(std::size_t cell_capacity)
      : first_cleaning_(std::min(kFirstCleaning, cell_capacity / kCellsPerEntry)) {}
  /// An upper bound of the bytes that the lists of `num_workers` workers take in addition to kGrowth entries
  /// per live cell and two chunks.
  static std::size_t stale_bytes(std::size_t cell_capacity, std::size_t num_workers) {
    return num_workers * 2 * sizeof(Entry) * std::min(kFirstCleaning, cell_capacity / kCellsPerEntry);
  }

  /// Throws std::bad_alloc. Calls of this function would take 1 % of all instructions.
  [[gnu::always_inline]] void push(CellId cell, std::uint16_t stamp) {
    if (end_ % kChunk == 0) begin_chunk();
    top_[end_++ % kChunk] = {cell, stamp};
  }
  /// True if many entries may be stale. Dropping them keeps the list short.
  bool is_due_for_cleaning() const { return size() >= next_cleaning_; }
  void drop_stale(const Mesh& mesh) {
    std::size_t kept = begin_;
    for (std::size_t i = begin_; i < end_;) {
      const std::size_t chunk_end = std::min(end_, (i | (kChunk - 1)) + 1);
      const Entry* entry = &at(i);
      const Entry* const last = entry + (chunk_end - i) - 1;
      for (; i < chunk_end; ++i, ++entry) {
        mesh.prefetch(entry[std::min(kLookahead, last - entry)].cell);
        if (mesh.stamp(entry->cell) == entry->stamp) at(kept++) = *entry;
      }
    }
    end_ = kept;
    next_cleaning_ = std::max(first_cleaning_, kGrowth * size());
    give_back();
  }
  /// Removes the oldest entries, until `max` live ones are found or half of the list is removed. Returns the
  /// live ones.
  std::vector<Entry> take_oldest(std::size_t max, const Mesh& mesh) {
    std::vector<Entry> taken;
    for (const std::size_t half = begin_ + size() / 2; begin_ < half && taken.size() < max; ++begin_)
      if (mesh.stamp(at(begin_).cell) == at(begin_).stamp) taken.push_back(at(begin_));
    give_back();
    return taken;
  }
  bool is_empty() const { return begin_ == end_; }
  std::size_t size() const { return end_ - begin_; }
  /// Bytes that the list has asked of the system so far.
  std::uint64_t mapped_bytes() const { return num_mapped_ * kChunk * sizeof(Entry); }
  /// Returns the entry whose turn comes `turns` from now, or the oldest entry of a shorter list, for
  /// prefetching. The list must not be empty.
  Entry upcoming(std::size_t turns) const {
    const std::size_t in_top = end_ % kChunk;
    if (size() > turns && in_top > turns) return top_[in_top - 1 - turns];
    return at(size() > turns ? end_ - 1 - turns : begin_);
  }
  Entry pop() {
    if (end_ % kChunk == 0) {
      top_ = &at(end_ - kChunk);
      give_back();
    }
    return top_[--end_ % kChunk];
  }

 private:
  [[gnu::noinline]] void begin_chunk() {
    if (end_ == chunks_.size() << kChunkBits) {
      chunks_.emplace_back();
      ++num_mapped_;
    }
    top_ = &at(end_);
  }

  // A list that is not yet due for its first cleaning is short, in a small store too.
  static constexpr std::size_t kFirstCleaning = 1 << 16, kCellsPerEntry = 64;
  static constexpr std::ptrdiff_t kLookahead = 16;  // in a scan, whose cells lie anywhere in the store
  static constexpr std::size_t kChunkBits = 13, kChunk = 1 << kChunkBits;
  using Chunk = MappedChunk<Entry, kChunk>;

  Entry& at(std::size_t i) { return chunks_[i >> kChunkBits][i % kChunk]; }
  const Entry& at(std::size_t i) const { return chunks_[i >> kChunkBits][i % kChunk]; }
  // The list keeps the memory into which it will grow before its next cleaning, but at most as much as it
  // fills. The system takes longer to take pages back, which interrupts all threads, and to provide new ones
  // than the list takes to fill them. One chunk beyond the last entry may soon be needed. Chunks of taken
  // entries, at the front, serve again at the back, so that a list of which others take and to which its
  // worker adds asks the system for nothing.
  void give_back() {
    const std::size_t soon = std::min(next_cleaning_, 2 * size() + first_cleaning_),
                      kept = std::max(end_ + kChunk, begin_ + soon);
    const auto unused = static_cast<std::ptrdiff_t>(begin_ >> kChunkBits),
               used = static_cast<std::ptrdiff_t>((kept + kChunk - 1) >> kChunkBits);
    std::rotate(chunks_.begin(), chunks_.begin() + unused, chunks_.end());
    if (used - unused < std::ssize(chunks_)) chunks_.erase(chunks_.begin() + (used - unused), chunks_.end());
    begin_ %= kChunk;
    end_ -= static_cast<std::size_t>(unused) << kChunkBits;
    if (end_ % kChunk != 0) top_ = &at(end_ - end_ % kChunk);
  }

  std::size_t first_cleaning_;
  std::vector<Chunk> chunks_;
  std::uint64_t num_mapped_ = 0;
  std::size_t begin_ = 0, end_ = 0;  // positions of the oldest entry and of the next one to be pushed
  Entry* top_ = nullptr;             // the chunk of position end_, unless a chunk begins there
  std::size_t next_cleaning_ = first_cleaning_;
};

}  // namespace podm
