// Homes: blocks that tile space, one per computing node. A cell's home is the block that contains its
// circumcenter.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/point.h"

namespace podm {

class Homes {
 public:
  struct Work {
    Point at;
    double amount;
  };

  /// Makes blocks with equal shares of the work by recursive coordinate bisection: a block that stands for
  /// several homes is cut across its longest side. (Berger, Bokhari, IEEE Trans. Comput. C-36, 1987.)
  Homes(std::vector<Work> work, unsigned num_homes);

  unsigned number() const { return number_; }
  unsigned of(const Point& p) const {
    unsigned first = 0, count = number_;
    for (std::size_t cut = 0; count > 1;) {
      const unsigned half = count / 2;
      const bool is_low = coordinate(p, cuts_[cut].axis) < cuts_[cut].at;
      cut += is_low ? 1 : half;
      first += is_low ? 0 : half;
      count = is_low ? half : count - half;
    }
    return first;
  }

 private:
  struct Cut {
    unsigned axis;
    double at;
  };
  static double coordinate(const Point& p, unsigned axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
  static unsigned longest_side(std::span<const Work> work);
  void divide(std::span<Work> work, unsigned num_homes);

  unsigned number_;
  std::vector<Cut> cuts_;  // of a block, then of its low part, then of its high part
};

}  // namespace podm
