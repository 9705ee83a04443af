// The bounds on shape that every mesh of a complete run keeps.
#pragma once

namespace podm {

/// Radius-edge bound of every output cell: circumradius / shortest edge < kRadiusEdgeBound.
/// sqrt(2 + sqrt(3)) = 1.93185 in the proof; the published bound 1.93 is kept, see refine/rules.h for what
/// that costs.
inline constexpr double kRadiusEdgeBound = 1.93;
/// Every planar angle of every boundary facet exceeds this, in degrees.
inline constexpr double kFacetAngleBound = 30.0;
/// The most that the least dihedral angle may be asked to be, in degrees: a regular cell's are 70.5.
inline constexpr double kMostMinDihedral = 60.0;
/// Where dihedral angles below `min_dihedral_deg` are to be avoided, so are those above this, in degrees: 165
/// for 8, 160 for 12. Neither is kept at all costs.
constexpr double max_dihedral_deg(double min_dihedral_deg) { return 175 - 1.25 * min_dihedral_deg; }

}  // namespace podm
