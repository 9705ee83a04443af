// The bounds on shape that every mesh of a complete run keeps.
#pragma once

namespace podm {

/// Radius-edge bound of every output cell: circumradius / shortest edge < kRadiusEdgeBound.
/// sqrt(2 + sqrt(3)) = 1.93185 in the proof; the published bound 1.93 is kept, see refine/rules.h for what
/// that costs.
inline constexpr double kRadiusEdgeBound = 1.93;
/// Every planar angle of every boundary facet exceeds this, in degrees.
inline constexpr double kFacetAngleBound = 30.0;

}  // namespace podm
