// The invariants on which the proof of termination rests, as a check of any mesh of the refinement.
#pragma once

#include <string>

#include "delaunay/mesh.h"

namespace podm {

/// Returns m of rules.h: the least distance of two isosurface vertices, at most `spacing_mm`.
double least_sample_distance(const Mesh& mesh, double spacing_mm);

/// The fraction of the spacing s that a sample of R3 beside a vertex of R4 keeps from other samples: the
/// circumradius of a triangle with sides 1.93, 1.93 and 1, rounded down. See rules.h.
inline constexpr double kOneNearSample = 0.99910;

/// I1: isosurface vertices are at least kOneNearSample s apart. I2, I3: every other pair is at least 1.93 m
/// apart. Checks all edges, which is enough: nearest neighbors are joined by Delaunay edges. `slack` is the
/// relative error granted to the oracle and to rounding.
bool holds_invariants(const Mesh& mesh, double spacing_mm, double slack, std::string* fault = nullptr);

}  // namespace podm
