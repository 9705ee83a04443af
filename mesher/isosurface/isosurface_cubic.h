// Finds where a cubic first falls below zero. The weight difference of two labels along a segment within a
// block is a cubic.
#pragma once

#include <array>
#include <optional>

namespace podm {

/// The first s in [0,1] where c[0] + c[1] s + c[2] s^2 + c[3] s^3 falls below zero, or to zero unless
/// `zero_holds`. It is accurate to 1e-9. A dip narrower than 1e-6 may be missed.
std::optional<double> first_fall(const std::array<double, 4>& c, bool zero_holds);

}  // namespace podm
