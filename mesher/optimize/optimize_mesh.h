// Optimisation of a finished mesh on request: finds its cells with bad dihedral angles, and improves them by
// a team of workers in passes, each with other means than the one before.
#pragma once

#include <functional>

#include "algorithms/construction.h"
#include "optimize/optimizer.h"
#include "podm/meshing_report.h"

namespace podm {

/// Returns the aim for these bounds: 3/2 of the least angle, and a largest angle 4/3 as far below 180
/// degrees.
DihedralBounds aim_over(const DihedralBounds& bounds);

/// Improves the cells of all labels except the background; mesh.label() must be known for every cell. Runs
/// until it can do no more or the stop control ends it: the mesh is valid and no worse at any time.
/// Circumspheres of cells are not valid afterwards. One worker gives the same result every time. Throws
/// std::bad_alloc before it changes anything. If memory runs out later, the optimisation ends as at a limit.
/// The calling thread calls `observe` a few times per second with the fraction that is done, in passes and
/// their cells, not in time.
OptimizationReport optimize_mesh(
    Mesh& mesh, const OptimizerParameters& parameters, const Team& team, StopControl& stop,
    const std::function<void(double fraction)>& observe = [](double) {});

}  // namespace podm
