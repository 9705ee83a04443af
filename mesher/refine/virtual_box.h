// The boxes in which refinement happens. R2 may request a circumcenter outside the object. Such a point is
// moved onto the *clamp box*, the object's bounds widened by 2 delta. This is safe: a ball that meets the
// isosurface and whose center lies h outside the clamp box has a radius of at least h + 2 delta, so the moved
// center is still at least 2 delta from every vertex and inside the ball. The *virtual box* around it, whose
// eight corners are the first vertices, is larger, so that no vertex ever lies on the hull.
#pragma once

#include "geometry/box.h"

namespace podm {

inline Box clamp_box(const Box& object, double delta_mm) { return grown(object, 2 * delta_mm); }
inline Box virtual_box(const Box& clamp) { return grown(clamp, 0.25 * distance(clamp.low, clamp.high)); }

}  // namespace podm
