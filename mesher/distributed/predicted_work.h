// The work of a mesh by place, as predicted from the image.
#pragma once

#include "algorithms/construction.h"
#include "distributed/blocks.h"
#include "distributed/communication.h"
#include "distributed/cubes.h"

namespace podm {

/// Returns the number of cells that are predicted in each cube of this rank's share of the cubes, in
/// thousandths. It is computed on `threads` threads.
CubeWork predicted_work(const Problem& problem, const CubeGrid& grid, std::size_t threads,
                        const Communication& ranks);

}  // namespace podm
