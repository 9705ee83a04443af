// The bounds on cell and facet shape that the mesh of every complete run keeps.
#pragma once

namespace podm {

/// Radius-edge bound of every output cell: circumradius / shortest edge < kRadiusEdgeBound. The proof needs
/// sqrt(2 + sqrt(3)) = 1.93185. The code keeps the published bound 1.93; refine/rules.h states the
/// consequences.
inline constexpr double kRadiusEdgeBound = 1.93;
/// Lower bound on every planar angle of every boundary facet, degrees; the angle exceeds it.
inline constexpr double kFacetAngleBound = 30.0;
/// The same near lines, for facets with a vertex on a line: the angle whose sine is 1 / sqrt(8), rounded
/// down.
inline constexpr double kFacetAngleBoundNearLines = 20.7;
/// Largest least dihedral angle that an option may request, degrees. A regular cell has dihedral angles of
/// 70.5 degrees.
inline constexpr double kMostMinDihedral = 60.0;
/// Returns the upper dihedral angle bound that belongs to the lower bound `min_dihedral_deg`, both in
/// degrees: 165 for 8, 160 for 12. The mesher avoids angles outside the two bounds but does not guarantee
/// them.
constexpr double max_dihedral_deg(double min_dihedral_deg) { return 175 - 1.25 * min_dihedral_deg; }

}  // namespace podm
