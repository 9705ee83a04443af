// The invariants behind termination, as a check that can be called on any mesh of the refinement.
#pragma once

#include <string>

#include "delaunay/mesh.h"

namespace podm {

/// m of rules.h: the least distance of two isosurface vertices, or `spacing_mm` where that is less.
double least_sample_distance(const Mesh& mesh, double spacing_mm);

/// The part of the spacing s that one sample of R3 may keep from others, beside a vertex of R4: the
/// circumradius of a triangle with sides 1.93, 1.93 and 1, rounded down. See rules.h.
inline constexpr double kOneNearSample = 0.99910;

/// I1: isosurface vertices at least kOneNearSample s apart. I2, I3: every other pair at least 1.93 m.
/// Checked on all edges, which is enough: nearest neighbours are joined by Delaunay edges. `slack` is the
/// relative error granted to the oracle and to rounding.
bool holds_invariants(const Mesh& mesh, double spacing_mm, double slack, std::string* fault = nullptr);

}  // namespace podm
