// The bounds on shape that every mesh of a complete run keeps.
#pragma once

namespace podm {

/// Radius-edge bound of every output cell: circumradius / shortest edge < kRadiusEdgeBound.
/// sqrt(2 + sqrt(3)) = 1.93185 in the proof; the published bound 1.93 is kept, see refine/rules.h for what
/// that costs.
inline constexpr double kRadiusEdgeBound = 1.93;
/// Every planar angle of every boundary facet exceeds this, in degrees.
inline constexpr double kFacetAngleBound = 30.0;
/// Where small dihedral angles are to be avoided, so are those above this, in degrees. No bound that is kept:
/// it is best effort.
inline constexpr double kLargeDihedral = 165.0;
/// The most that small ones may be asked to have: a regular cell's are 70.5.
inline constexpr double kMostMinDihedral = 60.0;

}  // namespace podm
