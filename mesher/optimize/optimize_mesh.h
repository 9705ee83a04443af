// What happens to a finished mesh that is asked for better dihedral angles: its bad cells are found, and a
// team of workers makes them better in passes, each with other means than the one before.
#pragma once

#include <functional>

#include "algorithms/construction.h"
#include "optimize/optimizer.h"
#include "podm/meshing_report.h"

namespace podm {

/// Half as much again as the bounds.
DihedralBounds aim_over(const DihedralBounds& bounds);

/// Betters the cells of all labels but the background; mesh.label() must tell that of every cell. Goes on
/// until it can do no more or the stop control ends it: the mesh is valid and no worse at any time. Cells'
/// circumspheres are of no use afterwards. One worker does the same every time. Throws std::bad_alloc before
/// it changes anything; memory that ends later ends it as a limit does. `observe` is told a few times a
/// second, by the calling thread, how much of it is done: a share of passes and of their cells, not of time.
OptimizationReport optimize_mesh(
    Mesh& mesh, const OptimizerParameters& parameters, const Team& team, StopControl& stop,
    const std::function<void(double fraction)>& observe = [](double) {});

}  // namespace podm
