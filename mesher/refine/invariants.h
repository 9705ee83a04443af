// The invariants behind termination, as a check that can be called on any mesh of the refinement.
#pragma once

#include <string>

#include "delaunay/mesh.h"

namespace podm {

/// I1: isosurface vertices at least s apart. I2, I3: every other pair at least k s, k = sqrt(2 + sqrt(3)).
/// Checked on all edges, which is enough: nearest neighbours are joined by Delaunay edges. `slack` is the
/// relative error granted to the oracle and to rounding.
bool holds_invariants(const Mesh& mesh, double spacing_mm, double slack, std::string* fault = nullptr);

}  // namespace podm
