// The weight difference of two labels along a segment within a block is a cubic; here is where it first
// falls.
#pragma once

#include <array>
#include <optional>

#include "image/isosurface_block.h"

namespace podm {

/// Bernstein coefficients over [0,1]: the cubic lies in their convex hull, and has at most as many zeros in
/// (0,1) as they change sign.
using BernsteinCubic = std::array<double, 4>;

/// The interpolation of `v` along the segment from `p` to `q`, both in block coordinates.
BernsteinCubic along_segment(const CornerValues& v, const Point& p, const Point& q);

/// The first s in [0,1] where the cubic falls below zero, or to zero unless `zero_holds`; a dip narrower than
/// 1e-6 may be missed.
std::optional<double> first_fall(const BernsteinCubic& cubic, bool zero_holds);

}  // namespace podm
