// R7 as a phase of its own, the last, on a mesh that breaks no other rule (refine/perturbation.h).
#pragma once

#include "algorithms/construction.h"

namespace podm {

/// All of the team move vertices of cells with dihedral angles out of the problem's bounds, if it has some.
/// Charges the phase "perturb". The parameters are those that the mesh was refined with.
void perturb(Construction& construction, const Parameters& parameters);

}  // namespace podm
