// A uniform grid over axis-aligned boxes: which of them may meet a given box.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh.h"

namespace podm::verify {

struct Bounds {
  Point low{}, high{};
};
template <class Points>
Bounds bounds_of(const Points& points) {
  Bounds box{points[0], points[0]};
  for (const Point& p : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (p[a] < box.low[a]) box.low[a] = p[a];
      if (p[a] > box.high[a]) box.high[a] = p[a];
    }
  }
  return box;
}
inline bool meet(const Bounds& a, const Bounds& b) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (a.low[axis] > b.high[axis] || b.low[axis] > a.high[axis]) return false;
  return true;
}

class BoxGrid {
 public:
  /// About one bin a box, of the boxes' mean size; boxes must be finite.
  explicit BoxGrid(const std::vector<Bounds>& boxes);

  /// Calls visit(i) for every box i that shares a bin with `box`, some more than once.
  template <class Visit>
  void for_each_near(const Bounds& box, Visit&& visit) const {
    const auto low = bin_of(box.low), high = bin_of(box.high);
    for (std::size_t k = low[2]; k <= high[2]; ++k) {
      for (std::size_t j = low[1]; j <= high[1]; ++j) {
        const std::size_t row = (k * size_[1] + j) * size_[0];
        for (std::size_t i = start_[row + low[0]]; i < start_[row + high[0] + 1]; ++i) visit(members_[i]);
      }
    }
  }

 private:
  std::array<std::size_t, 3> bin_of(const Point& p) const;

  Bounds extent_;
  std::array<std::size_t, 3> size_{1, 1, 1};
  Point bins_a_unit_{};
  std::vector<std::size_t> start_;
  std::vector<std::uint32_t> members_;
};

}  // namespace podm::verify
