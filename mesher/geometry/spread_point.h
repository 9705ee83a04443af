// Points that fill a cube evenly, for any number of points.
#pragma once

#include <cmath>
#include <cstddef>

#include "geometry/point.h"

namespace podm {

/// Returns the n-th point of an additive recurrence in the unit cube with the powers of g, g^4 = g + 1. The
/// recurrence leaves no large gaps, and no two points share a coordinate (M. Roberts, "The unreasonable
/// effectiveness of quasirandom sequences", 2018).
inline Point spread_point(std::size_t n) {
  constexpr double kG = 1.2207440846057596;
  const auto step = static_cast<double>(n);
  const auto fraction = [](double x) { return x - std::floor(x); };
  return {fraction(0.5 + step / kG), fraction(0.5 + step / (kG * kG)), fraction(0.5 + step / (kG * kG * kG))};
}

}  // namespace podm
