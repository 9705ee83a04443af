// Axis-aligned boxes.
#pragma once

#include "geometry/point.h"

namespace podm {

/// A box given by two opposite corners.
struct Box {
  Point low, high;
};

/// True if p is in the box or on its boundary.
inline bool is_in(const Box& box, const Point& p) {
  return box.low.x <= p.x && p.x <= box.high.x && box.low.y <= p.y && p.y <= box.high.y && box.low.z <= p.z &&
         p.z <= box.high.z;
}

/// Returns the box widened by `margin` on each side.
inline Box grown(const Box& box, double margin) {
  const Vector m{margin, margin, margin};
  return {box.low - m, box.high + m};
}

}  // namespace podm
