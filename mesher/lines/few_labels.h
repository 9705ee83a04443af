// Small sets of labels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// At most nine labels in ascending order: those of a block, and the background beyond the box.
class FewLabels {
 public:
  static constexpr std::size_t kMost = 9;

  const LabelIndex* begin() const { return labels_.data(); }
  const LabelIndex* end() const { return labels_.data() + count_; }
  std::size_t size() const { return count_; }
  LabelIndex operator[](std::size_t i) const { return labels_[i]; }
  bool contains(LabelIndex label) const { return std::find(begin(), end(), label) != end(); }

  void insert(LabelIndex label) {
    if (contains(label)) return;
    std::size_t at = count_++;
    for (; at > 0 && labels_[at - 1] > label; --at) labels_[at] = labels_[at - 1];
    labels_[at] = label;
  }
  void insert(const FewLabels& others) {
    for (const LabelIndex label : others) insert(label);
  }
  std::vector<LabelIndex> list() const { return {begin(), end()}; }
  friend bool operator==(const FewLabels& a, const FewLabels& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  std::array<LabelIndex, kMost> labels_{};
  std::uint8_t count_ = 0;
};

}  // namespace podm
