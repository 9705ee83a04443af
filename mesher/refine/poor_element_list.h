// The poor element list (PEL): cells that may break a rule, last in first out. Entries are classified only
// when their turn comes; by then most have died, which their stamp shows. Last-in-first-out keeps the work
// where the cache is warm.
#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"

namespace podm {

class PoorElementList {
 public:
  struct Entry {
    CellId cell;
    std::uint32_t stamp;
  };
  void push(CellId cell, std::uint32_t stamp) { entries_.push_back({cell, stamp}); }
  bool is_empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  Entry pop() {
    const Entry last = entries_.back();
    entries_.pop_back();
    return last;
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace podm
