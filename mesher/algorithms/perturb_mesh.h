// R7 as a phase of its own, the last one, on a mesh that violates no other rule (refine/perturbation.h).
#pragma once

#include "algorithms/construction.h"

namespace podm {

/// Moves vertices of cells with dihedral angles out of the problem's bounds, if it has bounds, with all
/// workers of the team, and then mends lines again. Charges the phase "perturb". `parameters` are those of
/// the refinement.
void perturb_mesh(Construction& construction, const Parameters& parameters);

}  // namespace podm
