// Searches for points where labels tie for the greatest weight.
#pragma once

#include <optional>

#include "geometry/box.h"
#include "geometry/point.h"
#include "lines/weight_forms.h"

namespace podm {

/// The point near `start` where the labels `tied`, two to four, have equal weights, which no other label
/// exceeds. The search follows Gauss and Newton; a step is the shortest of those that solve the linear
/// equations, and leads across the curve. None if the search fails, leaves `box` or ends farther than `reach`
/// from `start`. The point is accurate to 1e-9 of the block's side.
std::optional<Point> tie_point(const WeightForms& forms, SlotMask tied, const Point& start, const Box& box,
                               double reach);

}  // namespace podm
