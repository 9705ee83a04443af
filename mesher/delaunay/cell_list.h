// Cells in the order in which a walk over neighbours found them, each once.
#pragma once

#include <vector>

#include "delaunay/mesh.h"

namespace podm {

class CellList {
 public:
  void clear() {
    cells_.clear();
    table_.assign(kLeastSlots, kEmpty);
  }
  /// Returns false if the cell is in the list already.
  bool add(CellId c) {
    if (2 * (cells_.size() + 1) > table_.size()) grow();
    if (!take_slot(c)) return false;
    cells_.push_back(c);
    return true;
  }
  std::size_t size() const { return cells_.size(); }
  CellId operator[](std::size_t i) const { return cells_[i]; }

 private:
  static constexpr std::size_t kLeastSlots = 256;  // a power of two
  static constexpr CellId kEmpty = 0xffffffffu;

  bool take_slot(CellId c) {
    for (std::size_t i = c * 0x9e3779b9u >> 8;; ++i) {
      CellId& slot = table_[i & (table_.size() - 1)];
      if (slot == c) return false;
      if (slot != kEmpty) continue;
      slot = c;
      return true;
    }
  }
  void grow() {
    table_.assign(table_.empty() ? kLeastSlots : 2 * table_.size(), kEmpty);
    for (const CellId c : cells_) take_slot(c);
  }

  std::vector<CellId> cells_;
  std::vector<CellId> table_;  // open addressing
};

}  // namespace podm
